"""Position based fluid: one outer step, stage by stage. "Sn" is the stage of the boiling spec, section 1.

A sub-step predicts positions under gravity, corrects them until the density of the liquid is that of rest, and
takes the velocities from where the particles went. Positions and velocities both live at t^n.
"""

import math

import numpy as np

from melt.errors import MeltError
from melt.position_based import longest_step, surface_height
from melt.systems.melting import search


def settings_of(scene, depth):
    """Return the run-time choices of this page; ``depth`` [m] is the height of the liquid at the start."""
    pbf = scene.solver.pbf
    layers = max(1.0, depth / scene.spacing)
    return dict(
        iterations=pbf.iterations,
        spacing=scene.spacing,
        layers=layers,
        longest_step=longest_step(scene, layers),
        compression=pbf.compression,
    )


def start(do):
    """Nothing is derived before the first step."""


def step(do, dt):
    """Advance the state by one outer step of ``dt`` seconds."""
    clock = do.clock
    n_sub, sub_dt = sub_steps(do, dt)
    for _ in range(n_sub):
        do.pbf_predict(dt=sub_dt)  # S2: v + dt g, x + dt v
        lists(do)  # S3
        solve(do)  # S4: density
        do.pbf_velocity(dt=sub_dt)  # S5
        filters(do, sub_dt)  # S6
        if do.need.effect_precision:
            precision(do, sub_dt)  # S11: for the next sub-step
        if do.need.domain:
            do.leave_domain()
        clock.time += sub_dt
    do.pbf_bounds()
    keep_bounds(do)
    clock.step += 1


def lists(do):
    """Neighbours at the predicted positions, and who takes part in the solve (S3)."""
    search(do)
    do.pbf_begin()
    if do.need.effect_precision:
        do.pbf_list()
    do.iteration_key()
    do.active_list(iteration=0)
    do.pbf_separate()
    do.pbf_move()


def solve(do):
    """Correct positions, iteration by iteration; the lists stay those of the prediction (S4)."""
    for k in range(do.settings.iterations):
        if k > 0 and do.need.effect_precision:
            do.active_list(iteration=k)
        do.pbf_lambda()  # eqs (1), (4), (5)
        do.pbf_correction(iteration=k)  # eq (6)
        do.pbf_move()


def filters(do, sub_dt):
    """Vorticity confinement and XSPH, eqs (7), (8) (S6)."""
    if do.need.vorticity:
        do.vorticity_curl()
        do.vorticity_force(dt=sub_dt)
    if do.need.blend:
        do.pbf_xsph(dt=sub_dt)
        do.swap("velocity", "velocity_next")


def precision(do, sub_dt):
    """Support radius and iterations of each particle for the next sub-step, eq (15) (S11)."""
    do.height_histogram()
    height = surface_height(do.read("height_bins"), do.settings.spacing)
    do.effect_precision(height=height, dt=sub_dt)


def step_limits(do):
    """Return {bound: seconds} of the sub-step. Boiling spec 2.1, 6."""
    s = do.settings
    return {
        "compression": s.longest_step,
        "speed": 0.5 * s.spacing / max(do.clock.max_speed, 1e-12),
    }


def sub_steps(do, dt):
    """Return (n_sub, dt / n_sub), the fewest sub-steps that the limits allow, and note why.

    Speeds beyond the limit of n_sub_max sub-steps are cut (S2); compression is not.

    Raises:
        MeltError: the liquid's weight asks for more than ``n_sub_max`` sub-steps.
    """
    s = do.settings
    limits = step_limits(do)
    governing = min(limits, key=limits.get)
    n_sub = s.n_sub or max(1, math.ceil(dt / limits[governing] * (1 - 1e-9)))
    if s.n_sub is None and dt / limits["compression"] > s.n_sub_max * (1 + 1e-9):
        raise MeltError(
            f"time step: {s.layers:.0f} layers of liquid stay within {s.compression:.1%} compression for sub-steps of "
            f"{limits['compression']:.3g} s = sqrt(C J d omega' c2/(0.86 N g)), {math.ceil(dt / limits['compression'])} of "
            f"them in dt = {dt:g} s, but time.n_sub_max is {s.n_sub_max}: lower time.dt, raise time.n_sub_max or "
            "solver.pbf.iterations, or allow more with solver.pbf.compression"
        )
    if s.n_sub is None:
        n_sub = min(n_sub, s.n_sub_max)
    do.note("n_sub", n_sub)
    do.note("governing_bound", "given" if s.n_sub else governing)
    do.note("step_over_limit", dt / n_sub / limits[governing])  # above 1: speeds are cut, or a given n_sub is too small
    return n_sub, dt / n_sub


def keep_bounds(do):
    """Read the largest speed back, once per outer step."""
    speed, _ = np.asarray(do.read("pbf_bounds"), dtype=np.float64).max(axis=1)
    do.clock.max_speed = float(speed)
