"""The balanced form: a level surface is exactly at rest, a front has its whole pressure (flood E6, wb)."""

import numpy as np
import pytest
from flood_force_cases import TERRAIN, G, W, columns, dW, everywhere, nodes, run

from melt import params as P
from melt.reference._flood import sample


def sampled(x, terrain):
    """Bed elevations at x (n, 2)."""
    a = columns(x, terrain=terrain)
    return sample(a["position"], terrain, P.make(P.Terrain, np.float64, **TERRAIN), P.SAMPLER_BSPLINE)[0]


def basin(x, y):
    """A bowl with bumps; at its rim the bed stands above any surface of the tests."""
    return 0.02 * (x**2 + y**2) + 0.3 * np.sin(x) * np.cos(1.3 * y)


@everywhere
@pytest.mark.parametrize("jitter", [0.0, 0.1, 0.3])
def test_lake_at_rest_over_any_bed_is_exactly_at_rest(backend, jitter):
    """Columns wherever the bed is below the surface, shore included, in order or not; volumes fit the depths."""
    rng = np.random.default_rng(3)
    terrain = nodes(basin)
    x = np.stack(np.meshgrid(np.arange(-12, 12, 0.8), np.arange(-12, 12, 0.8)), -1).reshape(-1, 2)
    x = x + 0.8 * rng.uniform(-jitter, jitter, x.shape)
    b = sampled(x, terrain)
    x, b = x[b < 1.0], b[b < 1.0]
    n = len(x)
    fields = dict(bed=b, support_radius=np.full(n, 2.1), terrain=terrain)
    W_ij = W(np.hypot(*(x[:, None] - x[None]).transpose(2, 0, 1)), 2.1)
    V = 0.64 * (1.0 - b)
    for _ in range(100):
        V = V * np.clip((1.0 - b) / (W_ij @ V), 0.5, 2)
    a = columns(x, rest_volume=V, depth=1.0 - b, **fields)
    assert n > 100 and (1.0 - b).min() < 0.05
    assert np.abs(run("balanced_force", backend, a, lax_friedrichs=1.0, viscosity=0.1)).max() <= 1e-12
    # the same columns with the water a metre higher: those at the rim now stand at a front
    high = columns(x, rest_volume=V, depth=2.0 - b, **fields)
    assert np.abs(run("balanced_force", backend, high)).max() > 1


@everywhere
def test_front_on_a_flat_bed_is_that_of_the_symmetric_form(backend):
    """Equal depths: inside nothing acts, at the edge the whole pressure does."""
    i, j = np.divmod(np.arange(225), 15)
    a = columns(np.column_stack([i, j]), depth=np.full(225, 1.5), rest_volume=np.full(225, 1.5))
    whole = run("flood_force", backend, {**a}, form=P.FORM_SYMMETRIC)
    found = run("balanced_force", backend, a)
    edge = (np.minimum(i, 14 - i) == 0) | (np.minimum(j, 14 - j) == 0)
    inside = (np.abs(i - 7) < 5) & (np.abs(j - 7) < 5)
    assert found[:, edge] == pytest.approx(whole[:, edge], rel=1e-12, abs=1e-12)
    assert np.abs(found[:, inside]).max() == 0
    assert np.hypot(*found[:, edge]).min() > 1


@everywhere
def test_pair_by_hand(backend):
    """Both stand beside a void on a flat bed, so epsilon = 1: -g A (rise + d_i) times the slope."""
    V, h, d, r = [0.8, 1.3], [2.0, 3.0], [0.5, 0.7], 0.9
    a = columns([[0, 0], [r, 0]], rest_volume=V, support_radius=h, depth=d)
    slope = (dW(r, 2.0) + dW(r, 3.0)) / 2
    A = [V[1] / d[1], V[0] / d[0]]
    expected = [G * A[0] * slope * (0.2 + 0.5), -G * A[1] * slope * (-0.2 + 0.7)]
    assert run("balanced_force", backend, a)[0] == pytest.approx(expected, rel=1e-12)


@everywhere
def test_front_against_higher_ground_has_no_pressure(backend):
    """The bed one l into the void stands in the water by half the depth: half the pressure."""
    terrain = nodes(lambda x, y: np.where(x < 0, -0.5 * x, 0.0))  # rises to the left
    ell = 1.33
    # one column beside another: the void is at the left, probed at x = -2 - l
    x = np.array([[-2.0, 0.0], [-1.5, 0.0]])
    b = sampled(x, terrain)
    probe = 0.5 * (2.0 + ell)
    for d, share in ((2 * (probe - b[0]), 0.5), (0.9 * (probe - b[0]), 0.0), (1e3, 1 - (probe - b[0]) / 1e3)):
        a = columns(x, depth=b[0] + d - b, bed=b, terrain=terrain, rest_volume=[1.0, d])
        slope = dW(0.5, 2.66)
        found = run("balanced_force", backend, a)[0, 0]
        assert found == pytest.approx(share * G * d * slope * d / (b[0] + d - b[1]), rel=1e-9, abs=1e-12)


@everywhere
def test_unlike_surfaces_turn_the_pressure_on(backend):
    """Inside: t = |rise|/(0.02 d), 3 t^2 - 2 t^3; half way up it is a half."""
    i, j = np.divmod(np.arange(121), 11)
    x = np.column_stack([i, j]) + np.random.default_rng(0).uniform(-0.1, 0.1, (121, 2))
    d = np.ones(121)
    d[60] += 0.01  # the middle one: its neighbours see t = 1/2
    a = columns(x, depth=d, rest_volume=np.ones(121))
    found = run("balanced_force", backend, a)
    near = [49, 59, 61, 71]
    whole = run("flood_force", backend, {**a, "rest_volume": 1 / d}, form=P.FORM_SYMMETRIC)
    for k in near:
        r = np.hypot(*(x[60] - x[k]))
        level = G * 1 / 1.01 * 0.01 * dW(r, 2.66) * (x[60] - x[k]) / r
        rest = found[:, k] - level
        assert rest == pytest.approx(0.5 * whole[:, k], rel=1e-9)
    assert np.abs(whole[:, near]).min() > 1e-3


@everywhere
def test_walls_close_the_sum(backend):
    """Beside a wall the water is not at a front."""
    i, j = np.divmod(np.arange(121), 11)
    x, left = np.column_stack([i, j]), i < 6
    walls = np.column_stack([x[~left], np.full((~left).sum(), 5.0), np.ones((~left).sum())])
    fields = dict(depth=np.full(66, 1.4), rest_volume=np.full(66, 1.4))
    inside = (i[left] > 2) & (np.abs(j[left] - 5) < 3)
    found = run("balanced_force", backend, columns(x[left], walls=walls, **fields))
    assert np.abs(found[:, inside]).max() == 0
    assert np.abs(run("balanced_force", backend, columns(x[left], **fields))[:, inside]).max() > 3
