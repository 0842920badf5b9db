"""Solvers of an incompressible, viscous liquid, iteration by iteration. "Sn" is the stage of the slime spec, section 1.2.

Each solve changes velocities and returns a `Solved`: iterations, the residual that is left, and whether that is
within its tolerance. Who calls it decides what follows if it is not.
"""

import math
from typing import NamedTuple

import numpy as np

from melt.errors import NotFinite, Unstable
from melt.systems.steps import divide

DIVERGED = 10.0  # mean density error that no liquid has
#: The stage whose last call shows how a solve ended.
SHOWN = {"density": "pressure_update", "divergence": "pressure_update", "poisson": "poisson_step", "viscous": "viscous_step"}
CHECK = 4  # iterations of conjugate gradients between two looks at the residual


class Solved(NamedTuple):
    """What a solve came to."""

    name: str
    iterations: int
    residual: float  # mean error, or relative residual
    largest: float  # largest error of a particle (of conjugate gradients: the residual again)
    converged: bool
    loads: tuple = ()  # (kind, force (3, bodies) [N]) on moving bodies, where they are measured

    @property
    def finite(self):
        """Whether the residual is a number."""
        return math.isfinite(self.residual)


def operators(do):
    """Gradients to the neighbours, density ratio and DFSPH factor at the positions of now (S5b)."""
    do.mobility()
    do.pair_gradient()


def divergence(do, dt):
    """Remove compression that velocities would bring, and nothing else (S8)."""
    do.divergence_source(dt=dt)
    return _jacobi(do, dt, "divergence", do.settings.divergence_tolerance, 1)


def density(do, dt, ratio=None):
    """Remove compression that is there, and what velocities would bring (S9)."""
    velocity = "velocity"
    if do.need.semi_lagrangian and ratio is None:  # the density at the arrival has the rest
        do.arrival_correction(dt=dt)
        velocity = "velocity_correction"
    do.density_source(completed_ratio=ratio or _ratio(do), velocity=velocity, dt=dt)
    if do.need.closed:  # no surface yields: only differences of density can be removed
        do.source_mean()
        total, count = np.asarray(do.read("source_sums"), np.float64).sum(axis=1)
        do.shift_source(shift=float(total / max(count, 1)))
    return _jacobi(do, dt, "density", do.settings.density_tolerance, 2)


def _jacobi(do, dt, name, tolerance, least):
    """Relaxed Jacobi iteration of one of the two DFSPH solves, from the last step's pressure. Spec 2.7.

    Sprays and fragments have larger eigenvalues than liquid: where the iteration diverges it begins anew with half of
    the relaxation.
    """
    impulse, given = f"{name}_impulse", do.params["dfsph"]
    for share in (1.0, 0.5, 0.25, 0.125):
        if share < 1:
            do.params["dfsph"] = given._replace(omega=type(given.omega)(share * given.omega))
            do.forget()
        do.pressure_start(density_impulse=impulse, dt=dt)
        solved = _iterate(do, dt, name, tolerance, least)
        if not solved.residual > DIVERGED and solved.residual == solved.residual:
            break
    if share < 1:
        do.params["dfsph"] = given
        do.forget()
        tally(do, "relaxations", 1)
    do.pressure_kick(dt=dt)
    do.pressure_keep(density_impulse=impulse, dt=dt)
    return solved._replace(loads=_loads(do, "pressure"))


def _iterate(do, dt, name, tolerance, least):
    """Iterate until the mean error is within ``tolerance``, beyond `DIVERGED`, or the iterations are at an end."""
    mean = largest = 0.0
    since, before = 0, math.inf  # iterations since the momentum began
    for k in range(do.settings.max_iterations + 1):
        do.pressure_acceleration()
        if do.need.loads:  # of the pressure that acts, not of what the update makes of it
            do.pressure_load(mirror=0.0, dt=dt)
        do.pressure_update(dt=dt)
        sums = np.asarray(do.read("pressure_error"), np.float64)
        mean, largest = float(sums[0].sum() / max(sums[2].sum(), 1)), float(sums[1].max())
        # the error is that of the pressure before this update, which is what acts afterwards
        done = (k >= least and mean <= tolerance) or not mean <= DIVERGED
        if done and not do.recording:
            break
        if do.settings.accelerate:
            since = 0 if mean > before else since + 1  # where it went wrong the momentum begins anew
            do.pressure_extrapolate(momentum=(since - 1) / (since + 2) if since > 0 else 0.0)
            before = mean
        if do.recording:
            break
    return Solved(name, k, mean, largest, mean <= tolerance or do.recording)


def project(do, dt):
    """Pressure Poisson equation, zero (or surface tension's) at the free surface, and what it does to velocities (S7)."""
    if do.need.tension:
        do.surface_normal()
        do.surface_pressure(sigma=do.settings.sigma)
    do.poisson_pairs(completed_ratio=_ratio(do))
    do.poisson_start(completed_ratio=_ratio(do), dt=dt, shift=0.0)
    if do.need.closed:  # a constant may be added to the pressure: the right-hand side has to vanish in sum
        sums = np.asarray(do.read("poisson_sums"), np.float64).sum(axis=1)
        do.poisson_start(completed_ratio=_ratio(do), dt=dt, shift=float(sums[1] / max(sums[2], 1)))
    solved = _conjugate(do, "poisson", do.settings.poisson_tolerance, do.settings.poisson_iterations, lambda: do.poisson_apply())
    do.poisson_finish(completed_ratio=_ratio(do))
    do.poisson_acceleration(dt=dt)
    do.pressure_kick(dt=dt)
    if do.need.loads:
        do.pressure_load(mirror=1.0, dt=dt)
    return solved._replace(loads=_loads(do, "pressure"))


def _ratio(do):
    return "completed_ratio" if do.need.ghosts else "density_ratio"


def viscous(do, dt):
    """Implicit viscosity, together with incompressibility where the scene asks for it (S6b). Spec 2.11."""
    s = do.settings
    if do.need.shears:
        do.shear_rate()
    do.viscosity()
    do.pair_shear(dt=dt)
    do.restore_motion(position_kept="position", velocity_kept="velocity", position="position", velocity="velocity_free")
    outer, found = (s.outer if do.need.augmented else 1), []

    def apply():
        if do.need.augmented:
            do.dilation(velocity="viscous_direction")
        do.viscous_apply(dt=dt)

    for _ in range(outer):
        if do.need.augmented:
            do.dilation()
        do.viscous_start(dt=dt)
        found.append(_conjugate(do, "viscous", s.viscous_tolerance, s.viscous_iterations, apply))
        if do.need.augmented:
            do.dilation()
            do.viscous_keep()
    worst = max(found, key=lambda f: f.residual if f.residual == f.residual else math.inf)
    done = all(f.converged for f in found)
    return worst._replace(iterations=sum(f.iterations for f in found), converged=done, loads=_viscous_loads(do, dt))


def _viscous_loads(do, dt):
    """Return what viscosity, and the pressure that was solved with it, push moving bodies with."""
    if not do.need.loads:
        return ()
    do.shear_load()
    loads = _loads(do, "shear")
    if do.need.augmented:
        do.pressure_load(solver_pressure="viscous_pressure", mirror=0.0, dt=dt)
        loads += _loads(do, "pressure")
    return loads


def _loads(do, kind):
    """Return `Solved.loads` of the sums in `body_load`."""
    if not do.need.loads:
        return ()
    if do.recording:
        return ((kind, np.zeros((3, len(do.settings.bodies)))),)
    return ((kind, np.asarray(do.read("body_load"), np.float64).sum(axis=2)),)


def _conjugate(do, name, tolerance, limit, apply):
    """Preconditioned conjugate gradients on the fields of ``name``; sums rows: r.z, p.Ap, next r.z, r.r, b.b."""
    residual, k, size = 0.0, 0, 0.0
    for k in range(limit + 1):
        if k % CHECK == 0 or k == limit:
            sums = np.asarray(do.read(f"{name}_sums"), np.float64).sum(axis=1)
            # of a liquid at rest all that moves is walls: what they bring is in the first residual only
            size = sums[4] if sums[4] > 0 else max(size, sums[3] if k == 0 else 0.0)
            residual = math.sqrt(sums[3] / size) if size > 0 else float(sums[3])
            if residual <= tolerance or not math.isfinite(residual) or k == limit:
                break
        apply()
        getattr(do, f"{name}_step")()
        getattr(do, f"{name}_turn")()
        if do.recording:
            break
    return Solved(name, k, residual, residual, residual <= tolerance or do.recording)


def tally(do, name, count):
    """Add to a count of this outer step."""
    total = do.clock.tally[name] = do.clock.tally.get(name, 0) + count
    do.note(name, total)


def tally_loads(do, found, dt):
    """Add the impulse that the solves of a sub-step gave to moving bodies; `mean_loads` makes forces of it."""
    for solved in found:
        for kind, force in solved.loads:
            for body, name in do.settings.measured:
                for axis, value in zip("xyz", force[:, body]):
                    tally(do, f"force/{name}/{kind}_{axis}", float(value) * dt)


def mean_loads(do, dt):
    """Note the mean force over an outer step of ``dt`` on each body whose force is measured [N]."""
    for name, impulse in do.clock.tally.items():
        if name.startswith("force/"):
            do.note(name, impulse / dt)


def told(do, solved):
    """Note what a solve came to: iterations of the outer step, residual and largest error of the last sub-step."""
    tally(do, f"{solved.name}_iterations", solved.iterations)
    do.note(f"{solved.name}_residual", solved.residual)
    do.note(f"{solved.name}_error_max", solved.largest)


def tell(do, dt, failed):
    """Say which solve has not converged; end the run unless the scene says to go on.

    Raises:
        NotFinite: a residual is not a number.
        Unstable: which solve, after how many iterations, and what may help.
    """
    if not failed:
        return
    if not all(f.finite for f in failed):
        raise NotFinite
    words = "; ".join(f"{f.name} solve after {f.iterations} iterations: {f.residual:.3g}" for f in failed)
    text = f"at t = {do.clock.time:.5g} s a sub-step of {dt:.3g} s has not converged ({words})"
    if do.settings.on_fail == "warn":
        tally(do, "unconverged", 1)
        do.warning = f"{text}. Fix: a shorter time.dt, or more iterations (solver.dfsph.max_iterations, viscosity.max_iterations)"
        return
    raise Unstable(
        f"{text}.",
        remedy="The frames before are kept. Lower time.dt, raise solver.dfsph.max_iterations, poisson_iterations or "
        "viscosity.max_iterations, loosen the tolerance, or set solver.dfsph.on_fail = 'warn' to mark such frames and go on.",
        stage=SHOWN[failed[0].name],
    )


def step_limits(do):
    """Return {bound: seconds} of the sub-step: none for viscosity or sound. Spec 2.12."""
    s, clock = do.settings, do.clock
    limits = {"speed": s.courant * s.spacing / max(largest_speed(do), 1e-12)}
    if s.gravity > 0:
        limits["gravity"] = s.courant / 0.4 * 0.25 * math.sqrt(s.spacing / s.gravity)
    turns = [float(np.linalg.norm(body.spin)) for body in getattr(s, "bodies", ())]
    affine = max([getattr(clock, "largest_affine", 0.0), *turns])
    if affine > 0:
        limits["affine"] = 0.5 * s.courant / 0.4 / affine
    if s.capillary > 0:
        limits["capillary"] = 1 / math.sqrt(s.capillary)
    if s.elastic_speed > 0:
        limits["elastic"] = 0.3 * s.spacing / s.elastic_speed
    return limits


def largest_speed(do):
    """Return the speed that sub-steps are laid out for [m/s]: of liquid (at rest, of the start) and of moving bodies."""
    s, clock = do.settings, do.clock
    speed = clock.max_speed or getattr(s, "design_speed", 0.0)
    # the reach of bodies is not known here: a turn counts by the affine bound
    return max([speed, *(float(np.linalg.norm(body.speed(getattr(clock, "time", 0.0)))) for body in getattr(s, "bodies", ()))])


def sub_steps(do, dt):
    """Return (n_sub, dt / n_sub) of an outer step; see `melt.systems.steps.divide`."""
    remedy = "set a coarser domain.spacing"
    if not do.need.semi_lagrangian:
        remedy = "set solver.dfsph.semi_lagrangian = true, which lets longer steps of viscous liquids through"
    return divide(do, dt, step_limits(do), f"largest speed {largest_speed(do):.3g} m/s", remedy, "slime_bounds")
