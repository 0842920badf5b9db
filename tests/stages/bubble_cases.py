"""Pools of liquid, bubbles and vapour with brute-force lists, and the parameters of bubbles in water."""

import numpy as np
from liquid_cases import REALS
from pbf_cases import D, arrays, pbf_tuple, vessel_tuple
from stage_runs import run_with

from melt import params as P

LIQUID, SOLID, WALL, BUBBLE, VAPOUR, INACTIVE = range(6)
R = 2.2 * D
G, RHO, GAS, ADDED, DRAG = 9.81, 1000.0, 0.6, 0.5, 8 / 3
INERTIA = GAS + ADDED * RHO
FAR = dict(lower_x=-1e30, lower_y=-1e30, lower_z=-1e30, upper_x=1e30, upper_y=1e30, upper_z=1e30)
BUBBLES = dict(
    spacing=D, birth_radius=(3 / (16 * np.pi)) ** (1 / 3) * D, birth_reach=D, inertia=INERTIA, rise_x=0.0, rise_y=0.0,
    rise_z=G * (RHO - GAS) / INERTIA, drag=3 / 8 * DRAG * RHO / INERTIA, literal_radius=0, growth=1 / 3,
    radius_height=0.75, radius_rate=0.25, depth=0.24, growth_time=0.5, largest=2 * R, most_volume=4.2 * D**3,
    merge_age=0.1, plain_mean=0, upward=0, drift=0.1 * R * 60, normalised=1, burst_radius=0.45 * D, push_reach=1.5 * R,
    push_side=12.0, push_up=18.0, push_even=0, floor=0.0, **FAR,
)
VAPOUR_VALUES = dict(
    support=R, minimum_support=0.5 * R, mass=GAS * D**3, rest_density=0.1, stiffness=50.0, buoyancy_x=0.0,
    buoyancy_y=0.0, buoyancy_z=0.03, air_temperature=20.0, drag=1.0, life=3.0, density_share=0.5, adapt=1, per_burst=2,
    spread=D,
)
BOILING = dict(
    diffusivity=1e-3, corrected=1, specific_heat=4186.0, boiling_point=100.0, latent_heat=4.5e4, start_temperature=20.0,
    threshold=0, seed_low=1, seed_high=0, mass_model=0, subcooling=0.0, heater_lower_x=0.0, heater_upper_x=1.0,
    heater_lower_y=0.0, heater_upper_y=1.0, contact=D, boost=0, boost_rate=0.0, boost_speed=1.0, expansion=0.0,
)
KINDS = dict(bubbles=(P.Bubbles, BUBBLES), vapour=(P.Vapour, VAPOUR_VALUES), boiling=(P.Boiling, BOILING))


def terminal_speed(radius):
    """Speed of a bubble relative to the liquid [m/s], spec 2.5."""
    return np.sqrt(8 * radius * G * (RHO - GAS) / (3 * DRAG * RHO))


def rows(x, phase, reach=R):
    """Neighbours strictly within reach, ascending, without itself; none for walls and inactive."""
    r2 = ((x[:, None] - x[None]) ** 2).sum(axis=2)
    near = (r2 < reach * reach) & (phase != INACTIVE)[None] & ((phase != WALL) & (phase != INACTIVE))[:, None]
    np.fill_diagonal(near, False)
    count = near.sum(axis=1)
    index = np.full((len(x), max(8, count.max(initial=0))), -987654321)
    for i, row in enumerate(near):
        index[i, : count[i]] = np.flatnonzero(row)
    return dict(neighbour_count=count, neighbour_index=index)


def pool(x, phase, precision="double", reach=R, **fields):
    """Return all fields for particles at x (n, 3); bubbles are listed by slot, radius ``bubble_radius``."""
    x = np.asarray(x, float).reshape(-1, 3)
    phase = np.broadcast_to(np.asarray(phase, np.int32), len(x)).copy()
    listed = np.full(len(x), -987654321)
    bubbles = np.flatnonzero(phase == BUBBLE)
    listed[: len(bubbles)] = bubbles
    given = dict(rows(x, phase, reach), bubble_index=listed, bubble_count=[len(bubbles)])
    return arrays(x, phase, precision, **{**given, **fields})


def run(stage, backend, a, **changes):
    """Run a stage, put what it writes into ``a`` and return that; keywords change parameters or are scalars."""
    real = a["mass"].dtype.type
    given = dict(pbf=pbf_tuple(real=real, uniform=changes.get("uniform", 1)), vessel=vessel_tuple(real, **changes.get("vessel", {})))
    return run_with(stage, backend, a, real, changes, KINDS, given)


def poly6(r, support=R):
    return 315 / (64 * np.pi * support**9) * (support**2 - r**2) ** 3


def rounding(precision):
    """Relative error of a few operations, and the type of the values."""
    return (1e-13 if precision == "double" else 3e-6), REALS[precision][0]
