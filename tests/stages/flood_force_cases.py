"""Columns for the stages of forces, control and drag, kernels written as in the spec, and how to run a stage."""

import numpy as np
import pytest
from stage_runs import run_with

from melt import params as P
from melt.fields import FIELDS
from melt.stages import STAGES
from melt.state import dtype_of

LIQUID, INACTIVE, AIRBORNE = 0, 5, 6
BACKENDS = ("reference", "cpu", "cuda-emulated")
G = 9.81
everywhere = pytest.mark.parametrize("backend", BACKENDS)
both = pytest.mark.parametrize("precision", ("single", "double"))

FLOOD = dict(
    gravity=G, kernel=P.CUBIC, sigma=1.0, ratio=2.66, smallest=1e-3, largest=1e3, growth=1.1, iterations=5, tolerance=1e-10,
    form=P.FORM_VARIATIONAL, stiffness=10.0, reference_depth=1.0, clamp=0, lax_friedrichs=0.0, viscosity=0.0, wall_mirror=1,
    shortest_wall=0.3, front=0.02,
)
TERRAIN = dict(origin_x=-20.0, origin_y=-20.0, inverse_dx=1.0, inverse_dy=1.0, nx=41, ny=41, sampler=P.SAMPLER_BSPLINE)
CONTROL = dict(mode=P.CONTROL_PAPER, slope_on=0.0, slope_full=0.0, spread=1.0, shortest=0.0, longest=1e9, probe=0.5)
FRICTION = dict(law=P.FRICTION_MANNING, value=0.0, mapped=0, thinnest=1e-3, control=0)
TUPLES = dict(
    flood=(P.Flood, FLOOD), terrain_grid=(P.Terrain, TERRAIN), control=(P.Control, CONTROL), friction=(P.Friction, FRICTION),
)


def nodes(height):
    """Return the nodes of the terrain with elevations ``height(x, y)``."""
    x = TERRAIN["origin_x"] + np.arange(TERRAIN["nx"]) / TERRAIN["inverse_dx"]
    y = TERRAIN["origin_y"] + np.arange(TERRAIN["ny"]) / TERRAIN["inverse_dy"]
    return (height(*np.meshgrid(x, y)) + np.zeros((TERRAIN["ny"], TERRAIN["nx"]))).ravel()


def dW(r, h, kernel=P.CUBIC):
    """dW/dr as the spec writes it: l = h/2."""
    ell = h / 2
    q = r / ell
    if kernel == P.CUBIC:
        s = 10 / (7 * np.pi * ell**3)
        return np.where(q < 1, s * (-3 * q + 2.25 * q**2), np.where(q < 2, -s * 0.75 * (2 - q) ** 2, 0))
    return np.where(q < 2, 7 / (4 * np.pi * ell**3) * -5 * q * (1 - q / 2) ** 3, 0)


def W(r, h, kernel=P.CUBIC):
    ell = h / 2
    q = r / ell
    if kernel == P.CUBIC:
        s = 10 / (7 * np.pi * ell**2)
        return np.where(q < 1, s * (1 - 1.5 * q**2 + 0.75 * q**3), np.where(q < 2, s * 0.25 * (2 - q) ** 3, 0))
    return np.where(q < 2, 7 / (4 * np.pi * ell**2) * (1 - q / 2) ** 4 * (1 + 2 * q), 0)


def _lists(x, others, reach, keep, self_too):
    r = np.hypot(x[0][:, None] - others[0], x[1][:, None] - others[1])
    near = (r < reach) & keep
    if not self_too:
        np.fill_diagonal(near, False)
    count = near.sum(axis=1)
    index = np.full((len(count), max(3, count.max(initial=0))), -987654321)
    for i, row in enumerate(near):
        index[i, : count[i]] = np.flatnonzero(row)
    return count, index


def columns(x, precision="double", phase=LIQUID, walls=None, **fields):
    """Return all fields of these stages for columns at x (n, 2); walls: rows x, y, bed, area of boundary particles."""
    x = np.asarray(x, float).reshape(-1, 2).T
    n = x.shape[1]
    phase = np.broadcast_to(phase, n)
    given = dict(
        id=np.arange(n), phase=phase, velocity=np.zeros((3, n)), rest_volume=np.ones(n), depth=np.ones(n), bed=np.zeros(n),
        support_radius=np.full(n, 2.66), support_factor=np.ones(n), bed_slope=np.zeros((2, n)), bed_curvature=np.zeros((3, n)),
        acceleration=np.zeros((2, n)), brake=np.zeros(n), depth_state=np.zeros(n), terrain=nodes(lambda x, y: 0 * x),
        terrain_friction=np.zeros(0), flood_bounds=np.zeros((6, 64)),
    )
    given.update(fields)
    given["velocity"] = np.vstack([given["velocity"], np.zeros((3, n))])[:3]
    given["position"] = np.vstack([x, np.reshape(given["bed"] + np.asarray(given["depth"]), (1, n))])
    before = given.get("position_before", x)
    given["position_before"] = np.vstack([before, np.zeros((3, n))])[:3]
    h = np.asarray(given["support_radius"], float)
    wet = (phase != INACTIVE)[:, None] & (phase == LIQUID)[None, :]
    given["neighbour_count"], given["neighbour_index"] = _lists(x, x, 1.1 * np.maximum(h[:, None], h), wet, False)
    walls = np.zeros((0, 4)) if walls is None else np.asarray(walls, float)
    given["boundary_position"], given["boundary_area"] = walls[:, :3].T, walls[:, 3]
    found = _lists(x, walls.T[:2], 1.1 * h[:, None], (phase == LIQUID)[:, None], True)
    given["wall_count"], given["wall_index"] = found if len(walls) else (np.zeros(0), np.zeros((0, 0)))
    return {k: np.ascontiguousarray(v, dtype=dtype_of(FIELDS[k], precision)) for k, v in given.items()}


def run(stage, backend, a, **changes):
    """Run a stage, put what it writes into ``a`` and return the first of it; keywords change parameters or give scalars."""
    out = run_with(stage, backend, a, a["depth"].dtype.type, changes, TUPLES)
    return out[STAGES[stage].writes[0]].astype(float)


def cloud(n=60, seed=1, precision="double", **fields):
    """Columns of unequal volume, depth, support and factor within a few supports, in motion."""
    rng = np.random.default_rng(seed)
    given = dict(
        rest_volume=rng.uniform(0.3, 2, n), depth=rng.uniform(0.2, 3, n), support_radius=rng.uniform(1, 3, n),
        support_factor=rng.uniform(0.6, 1.1, n), velocity=rng.normal(size=(2, n)), id=rng.permutation(n),
    )
    given.update(fields)
    return columns(rng.uniform(0, 6, (n, 2)), precision, **given)
