"""Liquid that may boil, and solids that melt in it: one outer step, stage by stage. "Sn" is the stage of the boiling spec, section 1.

A sub-step predicts positions under gravity, corrects them until the density of the liquid is that of rest
(position based fluid), and takes the velocities from where the particles went; or it takes the pressure of
weakly compressible SPH instead. Positions, velocities and temperatures all live at t^n. Heat is in
`melt.systems.liquid_heat`, bubbles and vapour in `melt.systems.bubbles`. In the solve solids are walls that take the opposite of
each push; then shape matching puts their particles where their bodies have them (ADR 20).
"""

import math

import numpy as np

from melt.boiling import gravity_of, sph_sound_speed
from melt.errors import NotFinite, Unstable
from melt.physics.phases import SOLID
from melt.position_based import longest_step, surface_height
from melt.systems import bubbles
from melt.systems.heat import start_heat
from melt.systems.liquid_heat import boost, warm
from melt.systems.melting import liquefy, search
from melt.systems.steps import count
from melt.systems.topology import build_lattice


def settings_of(scene, liquid, top_speed, bubble_slots, vapour_slots):
    """Return the run-time choices of this page; ``liquid`` is a `melt.boiling.Liquid`, ``top_speed`` [m/s] that at the start."""
    pbf = scene.solver.pbf
    layers = max(1.0, liquid.depth / scene.spacing)
    chosen = dict(
        pressure=scene.solver.pressure,
        iterations=pbf.iterations,
        spacing=scene.spacing,
        layers=layers,
        compression=pbf.compression,
        design_speed=max(top_speed, math.sqrt(2 * gravity_of(scene)[0] * max(liquid.depth, scene.spacing)), 1e-12),
    )
    if scene.solver.pressure == "sph":
        c = sph_sound_speed(scene, liquid.depth)
        chosen.update(sph_sound_speed=c, longest_step=scene.solver.sph.cfl * scene.support / c)
        nu = scene.solver.sph.viscosity / scene.fluid.density
        chosen.update(viscous_step=0.125 * (0.5 * scene.support) ** 2 / nu if nu > 0 else math.inf)
    else:
        chosen.update(longest_step=longest_step(scene, layers))
    if scene.boiling is not None:
        chosen.update(boiling=scene.boiling, start_temperature=scene.fluid.temperature, liquid=liquid)
        chosen.update(bubble_slots=bubble_slots, vapour_slots=vapour_slots)
        chosen.update(particle_mass=scene.fluid.density * scene.spacing**3)
    return chosen


def start(do):
    """Derive thermal properties and the lattice of solids; begin the ledger of what boils."""
    if do.need.heat:
        start_heat(do)
    if do.need.solids:
        build_lattice(do)
    if do.need.boiling:
        bubbles.start(do)


def step(do, dt):
    """Advance the state by one outer step of ``dt`` seconds; a NaN or infinity ends it, as the largest speed."""
    try:
        _step(do, dt)
    except NotFinite:
        do.clock.max_speed = math.nan
    do.clock.step += 1


def _step(do, dt):
    need, clock = do.need, do.clock
    n_sub, sub_dt = sub_steps(do, dt)
    for _ in range(n_sub):
        if need.boiling:
            bubbles.births(do, sub_dt)  # S1
        if need.sph:
            squeeze(do, sub_dt)
        else:
            predict(do, sub_dt)  # S2
            lists(do)  # S3
            solve(do)  # S4: density
            if need.solids:
                shape(do)
            do.pbf_velocity(dt=sub_dt)  # S5
        filters(do, sub_dt)  # S6
        if need.boiling:
            bubbles.rise(do, sub_dt)  # S6: drag, S7
            bubbles.change(do, sub_dt)  # S8
        if need.boiling or need.heat:
            warm(do, sub_dt)  # S9
        if need.boost:
            boost(do, sub_dt)  # S10
        if need.effect_precision:
            precision(do, sub_dt)  # S11: for the next sub-step
        if need.vapour:
            bubbles.vapour(do, sub_dt)
        if need.condensate:
            bubbles.condense(do)
        if need.domain:
            do.leave_domain()
        clock.time += sub_dt
        clock.sub_step += 1
    liquefy(do)  # melting line 9-10
    do.pbf_bounds()
    keep_bounds(do)
    if need.boiling and bubbles.dry(do):
        do.warning = "all of the liquid has boiled away. Fix: a shorter time.end, or a weaker heater"


def predict(do, sub_dt):
    """Move liquid and bubbles as if nothing held them: v + dt a, x + dt v (S2)."""
    do.pbf_predict(dt=sub_dt)
    if bubbles.present(do):
        do.bubble_predict(dt=sub_dt)


def lists(do):
    """Neighbours at the predicted positions, and who takes part in the solve (S3)."""
    search(do)
    if bubbles.present(do):
        bubbles.listed(do)
    if do.need.solids:
        do.list_slots(flag="phase", key=SOLID, index="solid_index", count="solid_count")
    do.pbf_begin()
    if do.need.short_lists:
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
        if do.need.solids:
            do.solid_correction()
            do.pbf_move(active_index="solid_index", active_count="solid_count")
        do.pbf_move()
        if bubbles.present(do) and do.clock.largest_bubble > do.settings.spacing:
            do.bubble_exclude()


def shape(do):
    """Put the particles of solids where the rotations of their regions have them; momentum stays."""
    do.region_match()
    do.goal()
    do.goal_move()


def squeeze(do, sub_dt):
    """Pressure and viscosity of Mueller 2003's SPH at x^n in place of S2-S5: symplectic Euler (Table 1)."""
    search(do)
    if bubbles.present(do):
        bubbles.listed(do)
    do.pbf_begin()
    do.sph_density()
    do.sph_force(dt=sub_dt)
    do.swap("velocity", "velocity_next")
    predict(do, sub_dt)
    do.pbf_velocity(dt=sub_dt)  # what the walls stopped


def filters(do, sub_dt):
    """Vorticity confinement and XSPH, eqs (7), (8) (S6)."""
    if do.need.vorticity:
        do.vorticity_curl()
        do.vorticity_force(dt=sub_dt)
    if do.need.blend:
        if do.need.warm_viscosity:
            do.boost_xsph(dt=sub_dt)
        else:
            do.pbf_xsph(dt=sub_dt)
        do.swap("velocity", "velocity_next")


def precision(do, sub_dt):
    """Support radius and iterations of each particle for the next sub-step, eq (15) (S11)."""
    do.momentum_size()
    do.effect_precision(height=surface(do), dt=sub_dt)


def surface(do):
    """Return the height above the floor of what counts as surface [m]."""
    do.height_histogram()
    return surface_height(do.read("height_bins"), do.settings.spacing)


def step_limits(do):
    """Return {bound: seconds} of the sub-step. Boiling spec 2.1, 6.

    The speed is that of a fall through the liquid's height, not the one of now: shorter steps turn the same correction
    of positions into more speed, which would ask for still shorter ones (a pot in which a whole layer boiled at once
    threw its water out at 29 m/s).
    """
    s = do.settings
    limits = {
        "sound" if s.pressure == "sph" else "compression": s.longest_step,
        "speed": 0.5 * s.spacing / s.design_speed,
    }
    if s.pressure == "sph":
        limits["viscosity"] = s.viscous_step
    return limits


def sub_steps(do, dt):
    """Return (n_sub, dt / n_sub), the fewest sub-steps that the limits allow, and note why.

    Speeds above half a spacing in a sub-step are cut (S2).

    Raises:
        Unstable: the liquid's weight (or the sound speed) asks for more than ``n_sub_max`` sub-steps.
    """
    s = do.settings
    limits = step_limits(do)
    governing = min(limits, key=limits.get)
    n_sub = s.n_sub or count(do, dt, limits[governing])
    needed = min(s.longest_step, limits.get("viscosity", math.inf))
    if s.n_sub is None and dt / needed > s.n_sub_max * (1 + 1e-9):
        raise Unstable(_too_many(s, dt), stage="pbf_bounds")
    if s.n_sub is None:
        n_sub = min(n_sub, s.n_sub_max)  # of the speed: it is cut
    do.note("n_sub", n_sub)
    do.note("governing_bound", "given" if s.n_sub else governing)
    # above 1: speeds are cut, or a given n_sub is too small
    do.note("step_over_limit", dt / n_sub * max(1 / limits[governing], do.clock.max_speed / (0.5 * s.spacing)))
    return n_sub, dt / n_sub


def _too_many(s, dt):
    needed, most = math.ceil(dt / s.longest_step), f"time.n_sub_max is {s.n_sub_max}"
    if s.pressure == "sph" and s.viscous_step < s.longest_step:
        return (
            f"time step: solver.sph.viscosity allows sub-steps of {s.viscous_step:.3g} s, {math.ceil(dt / s.viscous_step)} of them "
            f"in dt = {dt:g} s, but {most}: lower time.dt, raise time.n_sub_max, or lower the viscosity."
        )
    if s.pressure == "sph":
        return (
            f"time step: a sound speed of {s.sph_sound_speed:.3g} m/s allows sub-steps of {s.longest_step:.3g} s, {needed} of "
            f"them in dt = {dt:g} s, but {most}: lower time.dt, raise time.n_sub_max, or lower solver.sph.sound_speed."
        )
    return (
        f"time step: {s.layers:.0f} layers of liquid stay within {s.compression:.1%} compression for sub-steps of "
        f"{s.longest_step:.3g} s = sqrt(C J d omega' c2/(0.86 N g)), {needed} of them in dt = {dt:g} s, but {most}: "
        "lower time.dt, raise time.n_sub_max or solver.pbf.iterations, or allow more with solver.pbf.compression."
    )


def keep_bounds(do):
    """Read the largest speed back, once per outer step."""
    speed, _ = np.asarray(do.read("pbf_bounds"), dtype=np.float64).max(axis=1)
    do.clock.max_speed = float(speed)
