"""Nodes, walls and their air ghost particles, for the tests of their stages."""

import numpy as np

from melt import params as P
from melt.check.compare import run_stage

BACKENDS = ("reference", "cpu", "cuda-emulated")
LIQUID, WALL = 0, 2
REST = 1.0  # d0 of the larger scenes
SEEDING = ("ghost_candidates", "ghost_thin", "ghost_list", "ghost_place", "ghost_volume")


def tuples(real, counts, edge=2.4, support=2.4, origin=(0, 0, 0), lengths=(0, 0, 0), **ghosts):
    """Return the parameter tuples by name; h = 2.4 d0, a lattice of about d0/2."""
    chosen = dict(
        across=5, flat=0, distance=0.85, jitter=0.25, fill=0.5, volume=1.0, plane=0.0, seed_low=5, seed_high=-9
    )
    chosen.update(ghosts)
    axes = "xyz"
    return dict(
        grid=P.make(
            P.Grid, real, **{f"origin_{a}": float(origin[k]) for k, a in enumerate(axes)}, inverse_cell=1 / edge,
            **{f"n{a}": counts[k] for k, a in enumerate(axes)},
        ),
        smoothing=P.make(
            P.Smoothing, real, support=support, kernel=P.CUBIC, laplacian=P.L_VISC, dimension=2 if chosen["flat"] else 3
        ),
        period=P.make(
            P.Period, real, **{f"length_{a}": float(lengths[k]) for k, a in enumerate(axes)},
            **{f"inverse_{a}": 1 / lengths[k] if lengths[k] else 0.0 for k, a in enumerate(axes)},
            **{f"lower_{a}": float(origin[k]) for k, a in enumerate(axes)},
        ),
        ghosts=P.make(P.Ghosts, real, pitch=edge / chosen["across"], **chosen),
        poisson=P.make(
            P.Poisson, real, rest_density=1000.0, floor=1e-4 * support**2, pull=0.02, full_share=0.85, clamp=0
        ),
    )


def arrays(x, phase, params, real=np.float64, volume=1.0, room=30000):
    """Return the arrays of the stages for particles at x (n, 3), brought into cell order."""
    x = np.asarray(x, dtype=float).reshape(-1, 3)
    n, grid, ghosts = len(x), params["grid"], params["ghosts"]
    cells = int(grid.nx) * int(grid.ny) * int(grid.nz)
    a = dict(
        position=np.ascontiguousarray(x.T, dtype=real), phase=np.broadcast_to(phase, n).astype(np.int32),
        cell=np.empty(n, np.int32),
    )
    a.update(run_stage("cell_index", "reference", a, params))
    order = np.argsort(a["cell"], kind="stable")
    cell = a["cell"][order]
    return dict(
        position=np.ascontiguousarray(a["position"][:, order]), phase=a["phase"][order],
        volume=np.broadcast_to(volume, n).astype(real)[order],
        cell_start=np.searchsorted(cell, np.arange(cells + 2)).astype(np.int32),
        ghost_state=np.zeros(cells * int(ghosts.across) ** (2 if ghosts.flat else 3), np.int32),
        ghost_start=np.zeros(cells + 2, np.int32), chunk_sum=np.zeros(cells // 256 + 1, np.int32),
        ghost_position=np.zeros((3, room), real), ghost_volume=np.zeros(room, real),
        density_ratio=np.full(n, 0.8, real), dfsph_factor=np.ones(n, real), completed_ratio=np.zeros(n, real),
        ghost_laplacian=np.zeros(n, real),
    )


def seeded(a, params, backend="cpu"):
    """Run the stages that seed ghosts; return their positions (m, 3)."""
    for stage in SEEDING:
        a.update(run_stage(stage, backend, a, params))
    return a["ghost_position"][:, : a["ghost_start"][-1]].T.astype(float)


def lattice(counts, jitter, rng):
    """Return a lattice of spacing 1 with jitter, (n, 3)."""
    x = np.stack(np.meshgrid(*[np.arange(k) for k in counts], indexing="ij"), -1).reshape(-1, 3) + 0.5
    return x + rng.uniform(-jitter, jitter, x.shape)


def in_room(x, phase, margin=3.0, **choice):
    """Return (arrays, params) of particles in a grid that ends ``margin`` outside of them."""
    origin = x.min(axis=0) - margin
    counts = [int(k) for k in np.floor((x.max(axis=0) + margin - origin) / 2.4) + 1]
    params = tuples(np.float64, counts, origin=origin, **choice)
    return arrays(x, phase, params), params
