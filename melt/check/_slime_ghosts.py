"""Inputs of the stages of air ghost particles for the check scene, by NumPy alone. Slime spec 2.8."""

import numpy as np

from melt.check._cloud import CELL, SPACING, cell_of

FILES = {"ghosts", "ghost_sums"}
EDGE = 4  # ghost candidates along a cell edge: pitch and cell edge are exact
SLOTS = 400


def periodic(n):
    """Return the choice of a scene that is periodic along x and y; x has two cells, and with many particles a strip behind them."""
    lengths = (1.25 if n >= 700 else 1.0, 1.5)
    return dict(n=n, length_x=lengths[0], length_y=lengths[1], inverse_x=1 / lengths[0], inverse_y=1 / lengths[1])


#: Variants: the plane, a periodic box, and more ghosts than there is room for.
FLAT = dict(flat=1, plane=0.71, dimension=2, volume=SPACING**2)
EXTRA = {
    **{name: [FLAT, periodic(301), periodic(900), {"n": 900}] for name in ("ghost_candidates", "ghost_thin")},
    **{name: [FLAT, {"room": 17}, {"room": 0}] for name in ("ghost_list", "ghost_place")},
    "ghost_volume": [periodic(301), periodic(900), {"room": 17}, {"room": 0}, {"dimension": 2}],
    "ghost_complete": [periodic(301), periodic(900), {"room": 17}, {"room": 0}, {"dimension": 2}],
}


def _wrapped(arrays, grid, choice):
    """Return the scene with its particles in the periodic box, in cell order."""
    x = arrays["position"].copy()
    for a, axis in enumerate("xyz"):
        length = choice.get(f"length_{axis}", 0.0)
        if length:
            x[a] = np.mod(x[a], length)  # the box begins at 0, as the grid does along x and y
    n = x.shape[1]
    cell = cell_of(x.T, arrays["phase"], grid)
    order = np.argsort(cell, kind="stable")
    moved = {
        name: np.ascontiguousarray(array[..., order])
        for name, array in {**arrays, "position": x}.items()
        if array.shape[-1:] == (n,) and name in ("position", "phase", "volume", "density_ratio", "dfsph_factor")
    }
    cells = grid["nx"] * grid["ny"] * grid["nz"]
    moved["cell_start"] = np.searchsorted(np.sort(cell), np.arange(cells + 2), side="left")
    return {**arrays, **moved}


def adapted(arrays, grid, choice):
    """Return the scene with ghosts in all states; as its variant asks, flat, periodic, or with little room."""
    n = len(arrays["phase"])
    rng = np.random.default_rng(n + 5)
    if "length_x" in choice:
        arrays = _wrapped(arrays, grid, choice)
    counts = np.array([grid["nx"], grid["ny"], grid["nz"]])
    cells = int(counts.prod())
    points = EDGE ** (2 if choice.get("flat") else 3)
    state = rng.choice(4, cells * points, p=[0.5, 0.45, 0.02, 0.03])
    state[cells * points // 2 :][:points] = 0  # a cell without any
    if choice.get("flat"):  # none outside the layer of cells that holds the plane
        layer = np.arange(cells) // counts[0] % counts[1]
        state[np.repeat(layer != int((choice["plane"] - grid["origin_y"]) / CELL), points)] = 0
    here = np.bincount(np.flatnonzero(state == 2) // points, minlength=cells)
    start = np.concatenate([[0], np.cumsum(here), [here.sum()]])
    room = choice.get("room", SLOTS)
    c = np.repeat(np.arange(cells), here)
    corner = np.stack([c % counts[0], c // counts[0] % counts[1], c // (counts[0] * counts[1])]) * CELL
    origin = np.array([[grid["origin_x"]], [grid["origin_y"]], [grid["origin_z"]]])
    inside = rng.integers(1, int(CELL * 4096), (3, c.size)) / 4096
    place = np.full((3, room), 0.1)
    place[:, : c.size] = (origin + corner + inside)[:, :room]
    return dict(
        arrays,
        ghost_state=state,
        ghost_start=start,
        ghost_position=place,
        ghost_volume=rng.uniform(0.5, 1.5, room) * SPACING**3,
    )


