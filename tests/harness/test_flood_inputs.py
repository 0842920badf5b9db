"""The check scene of the flood holds what can break its stages; checked by brute force, without the twins."""

import numpy as np
import pytest

from melt.check import _flood_values as V
from melt.check import inputs

A, GRID = inputs.flood_scene(301, 0)
X, H, PHASE = A["position"][:2], A["support_radius"], A["phase"]
R = np.hypot(*(X[:, :, None] - X[:, None, :]))
REACH = V.GROWTH * np.maximum(H[:, None], H)
LIQUID = PHASE == 0


def test_places_and_supports_are_exact_in_single_precision():
    for values in (X, H, A["boundary_position"][:2], A["entry_position"]):
        assert np.array_equal(values.astype(np.float32).astype(float), values)


def test_all_phases_stand_in_cell_order_with_the_inactive_last():
    assert set(np.unique(PHASE)) == {0, 5, 6}
    start = A["cell_start"]
    assert start[0] == 0 and start[-1] == len(PHASE) and (PHASE[start[-2] :] == 5).all() and (PHASE[: start[-2]] != 5).all()


def test_lists_are_brute_force_and_reach_covers_them():
    near = (R < REACH) & LIQUID[None] & (PHASE != 5)[:, None] & ~np.eye(len(PHASE), dtype=bool)
    cell = np.repeat(np.arange(len(A["cell_start"]) - 1), np.diff(A["cell_start"]))
    for i, row in enumerate(near):
        found = A["neighbour_index"][i, : A["neighbour_count"][i]]
        assert np.array_equal(found, np.flatnonzero(row))
        rings = [max(abs(cell[i] % GRID["nx"] - c % GRID["nx"]), abs(cell[i] // GRID["nx"] - c // GRID["nx"])) for c in cell[found]]
        assert max(rings, default=0) <= A["cell_reach"][cell[i]]


def test_extremes_are_there():
    apart = R[np.triu_indices(len(PHASE), 1)]
    assert (apart == 0).sum() >= 2, "coincident pairs"
    assert ((R == REACH) & LIQUID[:, None] & LIQUID).any(), "a pair exactly at its reach"
    assert ((R == H[:, None]) & LIQUID[:, None] & LIQUID).any(), "one exactly at another's support"
    assert (LIQUID & (A["neighbour_count"] == 0)).sum() >= 3, "isolated columns"
    assert np.abs(X).max() * GRID["inverse_cell"] > 2**29, "a runaway"
    assert H[LIQUID].max() / H[LIQUID].min() > 5 and A["depth"][LIQUID].max() / A["depth"][LIQUID].min() > 100
    assert len(np.unique(A["cell_reach"])) > 4 and (A["wall_count"] > 0).sum() > 20
    assert {0, 1, 2} <= set(A["depth_state"] & 3) and (A["depth_state"] & 4).any() and (A["depth_state"] & 8).any()
    assert (A["terrain_wall"] < 0).any() and np.abs(A["bed_slope"][0]).max() > 0.2


@pytest.mark.parametrize("n", [0, 1, 251, 730])
def test_scene_of_any_size_is_finite(n):
    arrays, _ = inputs.flood_scene(n, 0)
    assert len(arrays["phase"]) == n
    assert all(np.isfinite(a).all() for a in arrays.values())
