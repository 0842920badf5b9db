"""What a sub-step of an incompressible liquid costs on two CPU cores: pairs times iterations. For forecasts alone."""

import math

from melt.constants import lattice_offsets
from melt.slime.plan import needs_augmented

#: Seconds per pair of neighbours, measured on dam_break_dfsph, warm_honey, hydrostatic and slime_drop (mixed precision).
LISTS, DENSITY, POISSON, VISCOUS, AUGMENTED, APIC = 20e-9, 3e-9, 2e-9, 3e-9, 5e-9, 75e-9
GHOST_POINT = 0.1e-6  # of a place for ghosts
ITERATIONS = {"density": 13, "poisson": 25}


def viscous_iterations(scene):
    """Return about how many iterations of conjugate gradients a viscous solve takes: as the root of its stiffness."""
    v = scene.viscosity
    stiffness = v.mu * scene.time.dt / (scene.fluid.density * scene.support**2)
    if needs_augmented(scene):
        return v.outer * (4 + math.sqrt(1 + 10 * (1 + v.gamma) * stiffness))
    return 4 + math.sqrt(1 + 10 * stiffness)


def seconds_per_sub_step(scene, prepared, mobile):
    """Return (seconds, launches) of a sub-step with so many mobile particles; launches beside those of every stage once."""
    need, s = prepared.need, scene.solver.support
    pairs = mobile * (math.pi * s**2 if scene.domain.dimensions == 2 else lattice_offsets(s).size)
    seconds, launches = LISTS * pairs, 0.0
    for name, cost, stages in (("density", DENSITY, 3), ("poisson", POISSON, 3)):
        if need.dfsph if name == "density" else need.poisson:
            seconds += ITERATIONS[name] * cost * pairs
            launches += ITERATIONS[name] * stages
    if need.viscosity:
        count = viscous_iterations(scene)
        seconds += count * (AUGMENTED if need.augmented else VISCOUS) * pairs
        launches += count * (4 if need.augmented else 3)
    if need.apic:
        seconds += prepared.settings.apic_per_node * APIC * pairs * scene.solver.apic.support**scene.domain.dimensions
    if need.ghosts:
        seconds += GHOST_POINT * prepared.sizes["ghost_point"]
    return seconds * (prepared.settings.arrivals * 0.7 if prepared.settings.arrivals > 1 else 1), launches
