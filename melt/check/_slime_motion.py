"""Fields of the motion of slime for the check scene, and scenes with periodic axes, by NumPy alone."""

import numpy as np

from melt.check._cloud import LIQUID, RUNAWAY, SPACING, WALL, cell_of

DRIVEN = 7
#: Two periodic axes whose lengths are powers of two: whole lengths come off the runaway without rounding.
PERIODS = dict(length_x=1.0, inverse_x=1.0, lower_x=0.0, length_z=2.0, inverse_z=0.5, lower_z=-0.5)
#: Boxes of neighbour lists: 4 cells, beginning amid the cloud; 1 and 2 cells; 3 cells, the last one wider.
BOXES = (
    dict(
        length_x=2.0, inverse_x=0.5, lower_x=0.5, origin_x=0.5, nx=4,
        length_z=2.0, inverse_z=0.5, lower_z=0.5, origin_z=0.5, nz=4,
    ),
    dict(
        length_x=1.0, inverse_x=1.0, nx=2, length_y=0.5, inverse_y=2.0, ny=1,
        length_z=8.0, inverse_z=0.125, lower_z=-0.5, nz=16,
    ),
    dict(length_x=1.75, inverse_x=1 / 1.75, nx=3, length_y=1.5, inverse_y=1 / 1.5, ny=3),
)
EXTRA = {
    **{name: [PERIODS] for name in ("advect", "slime_bounds")},
    "pressure_load": [{"mirror": 0.0}],
    "pair_gradient": [PERIODS, {"dimension": 2}, {"dimension": 2, "kernel": 1}],
    "neighbours_periodic": [{"capacity": 20}, *({**each, "capacity": 160} for each in BOXES)],
}


def _motion(arrays, rng):
    """Some walls that move, two nozzles (one along an axis), APIC particles of which some are not active."""
    phase, x = arrays["phase"], arrays["position"]
    n = len(phase)
    moving = (phase == WALL) & (rng.random(n) < 0.5)
    tilted = np.array([0.48, 0.6, -0.64])
    middle = x[:, phase == LIQUID].clip(0, 1).mean(axis=1) if (phase == LIQUID).any() else np.zeros(3)
    place = np.array(
        [[*middle, 0, 0, -1, 1.9 * SPACING, 1.6 * SPACING], [*(middle + 0.2), *tilted, 2.9 * SPACING, 1.3 * SPACING]]
    )
    return dict(
        phase=np.where(moving, DRIVEN, phase),
        driver=np.where(moving, rng.integers(-1, 2, n), -1),
        driver_motion=rng.normal(size=(10, 2)),
        nozzle_place=place.T,
        nozzle_speed=np.array([0.7, -0.4]),
        apic_phase=np.where(rng.random(601) < 0.1, 5, 0),
    )


def _images(arrays, choice, rng):
    """Positions moved by whole lengths: distances to the nearest image, and the lists, stay what they were."""
    x = arrays["position"].copy()
    near = np.abs(x).max(axis=0, initial=0.0) < RUNAWAY / 2
    for a, name in enumerate("xyz"):
        x[a] += np.where(near, choice.get(f"length_{name}", 0.0) * rng.integers(-1, 2, x.shape[1]), 0.0)
    return dict(position=x)


def _boxed(arrays, grid, choice):
    """Positions inside the box, in the order of its cells."""
    x, phase = arrays["position"].copy(), arrays["phase"]
    grid = {**grid, **{k: v for k, v in choice.items() if k in grid}}
    for a, name in enumerate("xyz"):
        length, lower = choice.get(f"length_{name}", 0.0), choice.get(f"lower_{name}", 0.0)
        if length:
            x[a] -= length * np.floor((x[a] - lower) / length)
    cell = cell_of(x.T, phase, grid)
    order = np.argsort(cell, kind="stable")
    cells = grid["nx"] * grid["ny"] * grid["nz"]
    return dict(
        position=np.ascontiguousarray(x[:, order]), phase=phase[order],
        cell_start=np.searchsorted(cell[order], np.arange(cells + 2), side="left"),
    )


def adapted(stage, arrays, grid, choice):
    """Return the scene of a stage of slime as its file and its variant ask."""
    rng = np.random.default_rng(len(arrays["phase"]) + 7)
    if stage.file in ("slime_motion", "load"):
        arrays = {**arrays, **_motion(arrays, rng)}
    if stage.name == "neighbours_periodic" and "nx" in choice:
        return {**arrays, **_boxed(arrays, grid, choice)}
    if stage.name in EXTRA and "length_x" in choice:
        return {**arrays, **_images(arrays, choice, rng)}
    return arrays
