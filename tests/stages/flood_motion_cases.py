"""Columns of water, nodes, zones and points for the stages of motion, entry and maps, and how to run one."""

import numpy as np
from stage_runs import run_with

from melt import params as P
from melt.fields import FIELDS
from melt.state import dtype_of

LIQUID, INACTIVE, AIRBORNE = 0, 5, 6
FILES = ("flood_motion", "flood_guard", "flood_entry", "flood_sources", "flood_zones", "flood_sample")
GRID = dict(origin_x=0.0, origin_y=0.0, origin_z=0.0, inverse_cell=1.0, nx=6, ny=5, nz=1)
FLOOD = dict(
    gravity=9.81, kernel=P.CUBIC, sigma=1.0, ratio=2.0, smallest=0.25, largest=2.5, growth=1.1, iterations=5, tolerance=1e-10, form=0,
    stiffness=10.0, reference_depth=1.0, clamp=0, lax_friedrichs=1.0, viscosity=0.0, wall_mirror=1, shortest_wall=0.3, front=0.02,
)
TERRAIN = dict(origin_x=0.0, origin_y=0.0, inverse_dx=1.0, inverse_dy=1.0, nx=7, ny=6, sampler=0)
BASIN = dict(
    lower_x=0.0, lower_y=0.0, upper_x=6.0, upper_y=5.0, west=P.SIDE_WALL, east=P.SIDE_OPEN, south=P.SIDE_WALL, north=P.SIDE_OPEN,
    longest_move=0.5, guard=0, skin=0.125,
)
SAMPLING = dict(cover=0.5, wet=0.05)
TUPLES = dict(
    grid=(P.Grid, GRID), flood=(P.Flood, FLOOD), terrain_grid=(P.Terrain, TERRAIN), basin=(P.Basin, BASIN), sampling=(P.Sampling, SAMPLING),
)


def starts(x, phase):
    """Return cell_start of columns that are in cell order; asserts that they are."""
    nx, ny = GRID["nx"], GRID["ny"]
    place = np.clip(np.floor(np.nan_to_num(x[:2])), 0, np.array([[nx - 1], [ny - 1]])).astype(int)
    cell = np.where(phase == INACTIVE, nx * ny, place[1] * nx + place[0])
    assert (np.diff(cell) >= 0).all(), "columns of a case with a search stand in cell order"
    return np.searchsorted(cell, np.arange(nx * ny + 2))


def arrays(x, phase=LIQUID, precision="double", search=False, **fields):
    """Return all fields of these stages for columns at x (n, 3); ``search``: with cell starts, and every cell within reach."""
    x = np.asarray(x, float).reshape(-1, 3)
    n, cells = len(x), GRID["nx"] * GRID["ny"] + 2
    phase = np.broadcast_to(phase, n)
    given = dict(
        position=x.T, position_before=x.T, phase=phase, id=np.arange(n), mass=np.full(n, 1000.0), rest_volume=np.ones(n), depth=np.ones(n),
        bed=np.zeros(n), support_radius=np.full(n, 2.0), velocity=np.zeros((3, n)), acceleration=np.zeros((2, n)), brake=np.full(n, 7.0),
        left_volume=np.full((4, 64), 9.0), terrain_wall=np.full(TERRAIN["nx"] * TERRAIN["ny"], 1e6), cell_reach=np.full(cells, 9),
        cell_start=starts(x.T, phase) if search else np.zeros(cells),
    )
    given.update(fields)
    m = np.shape(given.get("sample_position", np.zeros((2, 0))))[1]
    for name in ("bed", "surface", "depth", "column", "speed"):
        given.setdefault(f"sample_{name}", np.zeros(m))
    for name in ("entry_clearance", "entry_volume"):
        given.setdefault(name, np.ones(np.shape(given.get("entry_position", np.zeros((3, 0))))[1]))
    given.setdefault("zone_sums", np.zeros((3, np.shape(given.get("zone_probe", np.zeros((4, 0))))[1])))
    return {k: np.ascontiguousarray(v, dtype=dtype_of(FIELDS[k], precision)) for k, v in given.items()}


def run(stage, backend, a, **changes):
    """Run a stage, put what it writes into ``a`` and return that; keywords change parameters or give scalars."""
    return run_with(stage, backend, a, a["rest_volume"].dtype.type, changes, TUPLES)
