"""What bounds the time step of a flood (flood E20)."""

import numpy as np
import pytest
from flood_force_cases import AIRBORNE, INACTIVE, G, both, columns, everywhere, run


@everywhere
@both
def test_rows_by_hand(backend, precision):
    """Two columns; the terrain is finer than the support of one of them: 1/2 m along x, 1/4 m along y."""
    v, acc, d, h = [[3.0, 0.3], [4.0, 0.4]], [[6.0, 0.0], [8.0, 30.0]], [2.0, 0.5], [4.0, 0.4]
    a = columns([[0, 0], [1, 0]], precision, velocity=v, acceleration=acc, depth=d, support_radius=h, depth_state=[1 + 4 + 8, 4 + 8])
    found = run("flood_bounds", backend, a, inverse_dx=2.0, inverse_dy=4.0)
    one = [(np.sqrt(G * 2) + 5) / 2, 5, 5 / 0.25, 5, 4, 1]
    two = [(np.sqrt(G * 0.5) + 0.5) / 0.2, 150, 0.5 / 0.2, 0.5, 0.4, 0]
    assert found.shape == (6, 64)
    assert found.max(axis=1)[:5] == pytest.approx(np.maximum(one, two)[:5], rel=1e-6 if precision == "single" else 1e-12)
    assert found[5].sum() == 1


@everywhere
def test_pieces_hold_what_is_theirs(backend):
    """200 columns in 64 pieces, each found once; bits 1 and 2 count, others do not."""
    n = 200
    speed, state = np.arange(1.0, n + 1), np.arange(n) % 16
    a = columns(np.zeros((n, 2)), velocity=[speed, 0 * speed], depth_state=state)
    found = run("flood_bounds", backend, a)
    last = [(p + 1) * n // 64 for p in range(64)]
    assert found[3].tolist() == [speed[k - 1] for k in last]
    assert found[5].sum() == ((state & 3) > 0).sum()


@everywhere
def test_columns_that_fall_or_wait_do_not_count(backend):
    a = columns(
        np.zeros((3, 2)), phase=[AIRBORNE, INACTIVE, 0], velocity=[[99, 99, 1], [0, 0, 0]], acceleration=np.array([[9, 9, 1], [0, 0, 0]]),
        support_radius=[9, 9, 2.0], depth_state=[1, 2, 3],
    )
    found = run("flood_bounds", backend, a)
    assert found[1:5].max(axis=1).tolist() == [1, 1, 1, 2] and found[5].sum() == 1


@everywhere
@both
@pytest.mark.parametrize(
    "field, rows", [("velocity", [0, 2, 3]), ("acceleration", [1]), ("depth", [0]), ("support_radius", [0, 1, 2, 4])]
)
def test_nan_counts_as_infinity(backend, precision, field, rows):
    a = columns(np.zeros((5, 2)), precision, velocity=np.ones((2, 5)), acceleration=np.ones((2, 5)))
    a[field][..., 3] = np.nan
    found = run("flood_bounds", backend, a).max(axis=1)
    assert np.flatnonzero(np.isinf(found)).tolist() == rows and not np.isnan(found).any()


@everywhere
@pytest.mark.parametrize("n", [0, 1])
def test_few_columns(backend, n):
    found = run("flood_bounds", backend, columns(np.zeros((n, 2))))
    assert (found.sum(axis=1) > 0).tolist() == [n == 1, False, False, False, n == 1, False]
