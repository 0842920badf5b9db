"""Fields and parameters of boiling for the check scene: some of its liquid turned into bubbles and vapour."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from melt.check._cloud import INACTIVE, LIQUID, SPACING, SUPPORT

BUBBLE, VAPOUR = 3, 4
#: Files of stages that are checked with bubbles about (others may be: choice ``bubbles``).
FILES = {
    "lists", "boil_heat", "boil_grid", "boost", "bubble_birth", "bubble_motion", "bubble_growth", "bubble_merge",
    "bubble_burst", "condense", "vapour", "sph",
}
#: Arguments of stages that work on fields which the page names.
NAMED = ("flag", "index", "count")
TANK = dict(origin_x=0.0, origin_y=0.0, origin_z=0.0, inverse_cell=16 / 3, nx=5, ny=4, nz=3, number=40.0, capacity=2.7e4)
VOXELS = TANK["nx"] * TANK["ny"] * TANK["nz"]
COARSE = 2

BOILING = dict(
    diffusivity=2.0,
    corrected=1,
    specific_heat=4187.0,
    boiling_point=100.0,
    latent_heat=3e4,
    start_temperature=20.0,
    threshold=700_000_000,
    seed_low=12345,
    seed_high=-7,
    mass_model=0,
    subcooling=2.0,
    heater_lower_x=0.2,
    heater_upper_x=1.0,
    heater_lower_y=0.3,
    heater_upper_y=1.1,
    contact=SPACING,
    boost=1,
    boost_rate=40.0,
    boost_speed=3.0,
    expansion=2e-3,
)

BUBBLES = dict(
    spacing=SPACING,
    birth_radius=0.39 * SPACING,
    birth_reach=SPACING,
    inertia=500.6,
    rise_x=0.2,
    rise_y=-0.1,
    rise_z=19.6,
    drag=2.0,
    literal_radius=0,
    growth=1 / 3,
    radius_height=0.05,
    radius_rate=0.25,
    depth=6 * SPACING,
    growth_time=0.2,
    largest=2 * SUPPORT,
    most_volume=4.2 * SPACING**3,
    merge_age=0.125,
    plain_mean=0,
    upward=0,
    drift=4.0,
    normalised=1,
    burst_radius=0.45 * SPACING,
    push_reach=1.5 * SUPPORT,
    push_side=12.0,
    push_up=18.0,
    push_even=0,
    floor=0.0,
    lower_x=0.0,
    lower_y=-1e30,
    lower_z=0.0,
    upper_x=1.5,
    upper_y=1e30,
    upper_z=1e30,
)

VAPOUR_VALUES = dict(
    support=SUPPORT,
    minimum_support=0.5 * SUPPORT,
    mass=0.6 * SPACING**3,
    rest_density=0.1,  # of a cloud as thin as that of the check scene
    stiffness=50.0,
    buoyancy_x=0.0,
    buoyancy_y=0.1,
    buoyancy_z=0.03,
    air_temperature=20.0,
    drag=1.0,
    life=0.25,
    density_share=0.7,
    adapt=1,
    per_burst=2,
    spread=SPACING,
)

CONDENSATE = dict(lower_x=0.1, lower_y=0.2, width_x=1.1, width_y=0.9, mass=1000 * SPACING**3, volume=SPACING**3, temperature=20.0)

SPH = dict(support=SUPPORT, rest_density=1000.0, stiffness=1.6e5, viscosity=3.0)


def fields(arrays, rng):
    """Return the fields of a scene in which nothing boils yet."""
    n, phase = len(arrays["phase"]), arrays["phase"]
    none = np.zeros(n, int)
    return dict(
        latent_store=np.where(phase == LIQUID, rng.uniform(0, 6e4, n), 0.0),
        heat_sum=np.where(phase == LIQUID, rng.uniform(0.3, 1.2, n), 0.0),
        voxel_temperature=rng.uniform(20, 110, VOXELS),
        bubble_volume=np.zeros(n),
        bubble_radius=np.zeros(n),
        birth_height=np.zeros(n),
        age=np.zeros(n),
        cargo=none,
        **_lists(phase, arrays["id"], none, none),
    )


def with_unequal_masses(arrays):
    """Return the scene with another mass for each particle, as where liquid comes from several solids."""
    share = np.random.default_rng(len(arrays["mass"])).uniform(0.7, 1.3, arrays["mass"].shape)
    return {**arrays, "mass": arrays["mass"] * share}


def _by_id(slots, ids):
    return slots[np.argsort(ids[slots])]


def _listed(slots, n):
    index = np.full(n, -987654321)
    index[: len(slots)] = slots
    return index, np.array([len(slots)])


def _lists(phase, ids, candidate, fate):
    """Return the lists that stages read, and the ones that general stages work on."""
    n, found = len(phase), {}
    for name, slots in (
        ("bubble", _by_id(np.flatnonzero(phase == BUBBLE), ids)),
        ("free", np.flatnonzero(phase == INACTIVE)),
        ("birth", _by_id(np.flatnonzero(candidate == 1), ids)),
        ("burst", _by_id(np.flatnonzero(fate == 2), ids)),
    ):
        found[f"{name}_index"], found[f"{name}_count"] = _listed(slots, n)
    index, count = _listed(np.flatnonzero(phase == BUBBLE), n)
    return dict(found, candidate=candidate, bubble_fate=fate, flag=phase, index=index, count=count)


def _merging(arrays, radius, age):
    """Return root and size of the bubbles that merge: connected components of overlapping old ones."""
    x, ids, phase = arrays["position"], arrays["id"], arrays["phase"]
    root, size = np.full(len(phase), -1), np.zeros(len(phase), int)
    slots = np.flatnonzero(phase == BUBBLE)
    if not slots.size:
        return root, size
    apart = np.sqrt(((x[:, slots, None] - x[:, None, slots]) ** 2).sum(axis=0))
    old = age[slots] >= BUBBLES["merge_age"]
    near = (apart <= radius[slots, None] + radius[None, slots]) & old[:, None] & old[None, :]
    labels = connected_components(coo_array(near), directed=False)[1]
    for label in range(labels.max() + 1):
        members = slots[labels == label]
        first = members[np.argmin(ids[members])]
        root[members], size[first] = first, len(members)
    return root, size


def _coarse(arrays, grid, phase):
    """Return coarse cell, order and cell starts of the bubbles; others stand in the last range."""
    origin = np.array([grid["origin_x"], grid["origin_y"], grid["origin_z"]])
    counts = np.array([grid["nx"], grid["ny"], grid["nz"]])
    fine = np.clip(np.floor((arrays["position"].T - origin) * grid["inverse_cell"]), 0, counts - 1).astype(int)
    c, some = fine // COARSE, (counts - 1) // COARSE + 1
    cell = np.where(phase == BUBBLE, c[:, 0] + some[0] * (c[:, 1] + some[1] * c[:, 2]), counts.prod())
    start = np.searchsorted(np.sort(cell), np.arange(counts.prod() + 2), side="left")
    return dict(bubble_cell=cell, bubble_order=np.argsort(cell, kind="stable"), bubble_start=start)


def _hot(n):
    """Return temperatures of which half are around the boiling point, some exactly there."""
    rng = np.random.default_rng(12)
    return np.where(rng.random(n) < 0.5, rng.uniform(20, 104, n), rng.integers(98, 105, n))


def with_bubbles(arrays, grid):
    """Return the scene with one in seven liquid particles a bubble and some vapour: small, large, old, young."""
    rng = np.random.default_rng(11)
    n, x = len(arrays["phase"]), arrays["position"]
    phase, draw = arrays["phase"].copy(), rng.random(n)
    liquid = phase == LIQUID
    phase[liquid & (draw < 0.15)] = BUBBLE
    phase[liquid & (draw > 0.92)] = VAPOUR
    bubble, vapour = phase == BUBBLE, phase == VAPOUR
    radius = np.where(bubble, rng.choice([0.3, 0.4, 0.45, 0.6, 0.9, 1.3, 2.5], n) * SPACING * rng.uniform(0.97, 1.03, n), 0.0)
    age = np.where(bubble | vapour, rng.choice([0.0, 0.0625, 0.125, 0.5], n), 0.0)
    candidate = ((phase == LIQUID) & (rng.random(n) < 0.1)).astype(int)
    fate = np.where(bubble, rng.choice([0, 1, 2], n), 0)
    height = np.where(phase == LIQUID, np.rint(np.clip(x[2] * 4096 / SPACING, 0, 1e6)), -1).astype(int)
    cell = np.floor((x[:2] - np.array([[grid["origin_x"]], [grid["origin_y"]]])) * grid["inverse_cell"])
    cell = np.clip(cell, 0, np.array([[grid["nx"] - 1], [grid["ny"] - 1]])).astype(int)
    column = np.full(grid["nx"] * grid["ny"], -1)
    np.maximum.at(column, cell[0] + grid["nx"] * cell[1], height)
    there = {**arrays, "phase": phase}
    root, size = _merging(there, radius, age)
    gone = bubble | vapour
    on = arrays["active_index"][: arrays["active_count"][0]]
    active, count = _listed(on[~gone[on]], n)  # liquid only
    return {
        **there,
        "temperature": np.where(liquid, _hot(n), arrays["temperature"]),
        "bubble_radius": radius,
        "bubble_volume": 4 / 3 * np.pi * radius**3 * np.minimum(rng.uniform(0.6, 1.2, n), 1.0),  # some did not grow
        "birth_height": np.where(bubble, np.maximum(x[2], 0) * rng.uniform(0, 1, n), 0.0),
        "age": age,
        "cargo": np.where(bubble, rng.integers(1, 9, n), 0),
        "bubble_push": np.where(bubble, rng.normal(size=(3, n)), 0.0) * 1000 * SPACING**6,
        "bubble_shift": rng.normal(size=(2, n)) * 0.05 * SPACING,
        "burst_top": np.where(fate == 2, x[2] + radius * rng.uniform(0.2, 1.0, n), 0.0),
        "merge_root": root,
        "merge_size": size,
        "surface_column": column,
        "vapour_density": np.where(vapour, rng.uniform(0.3, 1.5, n), 0.0),
        "vapour_pressure": np.where(vapour, rng.uniform(0, 4, n), 0.0),
        "vapour_push": np.where(vapour, rng.uniform(0, 0.05, n), 0.0),
        "vapour_support": np.where(vapour, rng.integers(80, 121, n) / 256, 0.0),
        "active_index": active,
        "active_count": count,
        **{name: np.where(gone, 0, arrays[name]) for name in ("mobility", "multiplier", "support_radius", "iterations")},
        **_coarse(arrays, grid, phase),
        **_lists(phase, arrays["id"], candidate, fate),
    }
