"""APIC particles of the check scene: around its liquid, some at its particles, some far from all, some inactive."""

import numpy as np

from melt.check._cloud import CELL, INACTIVE, LIQUID, SPACING, SUPPORT, cell_of, quantise

APICS, IDLE, LOST, OFFSETS = 601, 17, 9, 8
#: Files of stages that see the box of `PERIODIC` if asked for it.
FILES = ("apic_weights", "apic_nodes", "apic_back", "apic_stress")
#: A box of 2 by 3 by 4 cells, which the grid of every scene of at least 40 particles has.
PERIODIC = dict(
    length_x=2 * CELL, length_y=3 * CELL, length_z=4 * CELL, inverse_x=0.5 / CELL, inverse_y=1 / (3 * CELL), inverse_z=0.25 / CELL,
    lower_x=0.0, lower_y=0.0, lower_z=-CELL,
)
#: More variants of stages: the box, and the plane.
EXTRA = {
    **{name: [PERIODIC, {"dimension": 2}] for name in ("apic_weights", "apic_to_nodes", "nodes_to_apic", "elastic_force")},
    "massless_velocity": [PERIODIC],
    "apic_move": [PERIODIC],
}
SIX = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def _in_box(x):
    """Return positions (3, n) moved into the box of `PERIODIC`."""
    lower = np.array([PERIODIC[f"lower_{a}"] for a in "xyz"])[:, None]
    length = np.array([PERIODIC[f"length_{a}"] for a in "xyz"])[:, None]
    return lower + np.mod(x - lower, length)


def wrapped(arrays, grid):
    """Return the scene with its particles moved into the box of `PERIODIC`, in cell order; lists stay as they are."""
    x = _in_box(arrays["position"])
    cell = cell_of(x.T, arrays["phase"], grid)
    order = np.argsort(cell, kind="stable")
    start = np.searchsorted(cell[order], np.arange(len(arrays["cell_start"])))
    return {**arrays, "position": x[:, order], "phase": arrays["phase"][order], "cell_start": start}


def _particles(arrays, grid, rng, box):
    """Return positions (3, P), phase and cell starts of APIC particles in cell order."""
    nodes = arrays["position"][:, arrays["phase"] == LIQUID]
    home = nodes[:, rng.integers(0, nodes.shape[1], APICS)] if nodes.shape[1] else np.zeros((3, APICS))
    x = home + quantise(rng.uniform(-0.7, 0.7, (3, APICS)) * SPACING)
    x[:, :12] = home[:, :12]  # exactly at a node
    x[:, 12 : 12 + LOST] += 30 * SPACING
    phase = np.where(np.arange(APICS) < APICS - IDLE, 0, INACTIVE)
    if box:
        x = _in_box(x)
    cell = cell_of(x.T, phase, grid)
    order = np.argsort(cell, kind="stable")
    return x[:, order], phase[order], np.searchsorted(cell[order], np.arange(len(arrays["cell_start"])))


def _weights(x, nodes, box):
    """Return S, centre and the inverse second moment of the cubic spline."""
    d = nodes[:, :, None] - x[:, None, :]
    if box:
        length = np.array([PERIODIC[f"length_{a}"] for a in "xyz"])[:, None, None]
        d -= length * np.round(d / length)
    q = np.sqrt((d**2).sum(axis=0)) / SUPPORT
    s = 8 / (np.pi * SUPPORT**3)
    W = s * np.where(q < 0.5, 6 * q**3 - 6 * q**2 + 1, 2 * np.maximum(1 - q, 0) ** 3)
    S = W.sum(axis=0)
    S = np.where(S < 1e-3 * s, 0.0, S)
    w = np.where(S > 0, W / np.where(S > 0, S, 1.0), 0.0)
    centre = np.einsum("ip,aip->ap", w, d)
    e = d - centre[:, None]
    values, vectors = np.linalg.eigh(np.einsum("ip,aip,bip->pab", w, e, e))
    kept = values > 1e-3 * SUPPORT**2
    inverse = np.einsum("pak,pk,pbk->pab", vectors, np.where(kept, 1 / np.where(kept, values, 1.0), 0.0), vectors)
    return S, centre, np.array([inverse[:, a, b] for a, b in SIX])


def fields(arrays, grid, rng, box=False):
    """Return the fields of APIC particles; ``box``: in the periodic box, for a scene that is `wrapped`."""
    x, phase, start = _particles(arrays, grid, rng, box)
    S, centre, inverse = _weights(x, arrays["position"][:, arrays["phase"] == LIQUID], box)
    active = phase != INACTIVE
    root = np.eye(3)[:, :, None] + 0.3 * rng.normal(size=(3, 3, APICS))
    b = np.einsum("acp,bcp->abp", root, root)
    return dict(
        apic_start=start,
        apic_phase=phase,
        apic_position=x,
        apic_velocity=rng.normal(size=(3, APICS)),
        apic_affine=rng.normal(size=(9, APICS)) * 0.5 / SPACING,
        apic_mass=1000 * SPACING**3 / 8 * rng.uniform(0.5, 1.5, APICS),
        apic_strain=np.array([b[i, j] for i, j in SIX]),
        apic_state=np.where(active & (S == 0), 1, 0),
        apic_weight=np.where(active, S, 0.0),
        apic_centre=np.where(active, centre, 0.0),
        apic_inverse=np.where(active, inverse, 0.0),
        apic_offset=rng.uniform(-0.25, 0.25, (3, OFFSETS)) * SPACING,
    )


def with_particles(arrays, grid, file, box):
    """Return the scene with APIC particles, in the periodic box if the stages of a file of `FILES` are asked for it."""
    if file not in (*FILES, "apic_emit"):
        return arrays
    arrays = wrapped(arrays, grid) if box and file in FILES else arrays
    return {**arrays, **fields(arrays, grid, np.random.default_rng(len(arrays["phase"]) + 1), box)}
