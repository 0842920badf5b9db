"""What can be known of an incompressible scene before it runs: (level, text, fix)."""

import math

from melt.slime.plan import needs_augmented

#: Variance of the transfers' weights along an axis, in squared radii of the transfers (spec 2.5).
VARIANCE = {2: 0.079, 3: 0.075}
STIFF_SINGLE = 1e3  # mu dt/(rho h^2) above which conjugate gradients in float32 may stagnate


def numerical_viscosity(scene):
    """Return the viscosity [Pa s] that the transfers add at a wave length of 10 spacings. Spec 2.5."""
    sigma2 = VARIANCE[scene.domain.dimensions] * (scene.solver.apic.support * scene.support) ** 2
    k2 = (2 * math.pi / (10 * scene.spacing)) ** 2
    added = sigma2**2 * k2 / 2 if scene.solver.apic.affine else sigma2
    return scene.fluid.density * (1 - scene.solver.apic.flip) * added / scene.time.dt


def slime_findings(scene, prepared):
    """Return the findings of an incompressible scene."""
    return [*_transfers(scene), *_surface(scene, prepared), *_viscous(scene, prepared), *_solids(scene)]


def _transfers(scene):
    if scene.solver.apic is None:
        return []
    added, mu = numerical_viscosity(scene), 0.0 if scene.viscosity is None else scene.viscosity.mu
    text = (
        f"APIC transfers: with sub-steps of {scene.time.dt:g} s they add a viscosity of {added:.3g} Pa s at a wave length of 10 spacings "
        f"(more with shorter ones), the liquid has {mu:g}"
    )
    if added <= mu:
        return [("note", text, "")]
    return [("warning", text, "a finer domain.spacing, a smaller solver.apic.support, solver.apic.flip, or no [solver.apic]")]


def _surface(scene, prepared):
    """Without ghosts the Poisson equation finds the surface by what the kernel lacks; without a surface DFSPH has no way out."""
    if scene.fluid.enclosed and prepared.need.dfsph:
        text = f"fluid.enclosed: solver.pressure = {scene.solver.pressure} asks the same density of all particles where none can leave"
        return [("warning", text, "solver.pressure = isph with solver.dfsph.shift = 0.1")]
    if not prepared.need.poisson or prepared.need.ghosts or prepared.need.closed:
        return []
    text = f"solver.pressure = {scene.solver.pressure} without [solver.ghosts] takes what neighbours lack for air"
    return [("warning", text, "add [solver.ghosts], solver.pressure = dfsph, or fluid.enclosed where there is no surface")]


def _viscous(scene, prepared):
    v = scene.viscosity
    if v is None or v.mu == 0:
        return []
    stiffness = v.mu * scene.time.dt / (scene.fluid.density * scene.support**2)
    how = "together with incompressibility" if needs_augmented(scene) else "on its own"
    found = [("note", f"viscosity: mu dt/(rho h^2) = {stiffness:.3g}, solved {how}", "")]
    if prepared.precision != "double" and stiffness > STIFF_SINGLE:
        text = f"viscosity: with mu dt/(rho h^2) = {stiffness:.3g} the solve may stagnate in float32"
        found.append(("warning", text, "solver.precision = 'double', or a shorter time.dt"))
    pulls = "lets go of liquid at once, and what is below pulls at the layer that enters; hold = 4 keeps its speed"
    found += [
        ("note", f"inflow {n.name!r} {pulls}", "")
        for n in scene.inflow
        if n.hold == 0
    ]
    return found


def _solids(scene):
    if not scene.solid or scene.solver.dfsph.on_fail != "retry":
        return []
    return [("note", "solids: a sub-step that does not converge is not tried again in two halves, the run stops (see on_fail)", "")]
