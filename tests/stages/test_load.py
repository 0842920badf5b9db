"""Force of the liquid on moving bodies, by hand."""

import numpy as np
import pytest
from dfsph_cases import BACKENDS, TUPLES, run

from melt import params as P
from melt.fields import FIELDS
from melt.state import dtype_of

everywhere = pytest.mark.parametrize("backend", BACKENDS)
both = pytest.mark.parametrize("precision", ("single", "mixed", "double"))
TUPLES.setdefault("poisson", (P.Poisson, dict(rest_density=1000.0, floor=0.0, pull=0.0, full_share=0.85, clamp=0, full=0.0)))


def fields(precision, **given):
    """Two liquid particles and one of given velocity, then a particle of body 1 and a wall."""
    index = np.full((5, 4), -987654321)
    index[0, :3], index[1, :2], index[2, 0] = [1, 3, 4], [0, 3], 3
    given |= dict(
        driver=[-1, -1, -1, 1, -1], neighbour_count=[3, 2, 1, 0, 0], neighbour_index=index, body_load=np.full((3, 2, 64), np.nan),
    )
    return {name: np.array(value, dtype_of(FIELDS[name], precision), order="C") for name, value in given.items()}


@everywhere
@both
@pytest.mark.parametrize(("mirror", "full"), [(0.0, 60.0), (1.0, 60.0), (1.0, 0.0)])
def test_pressure_by_hand(backend, precision, mirror, full):
    g = np.zeros((3, 5, 4))
    g[:, 0, 1], g[:, 1, 1], g[:, 2, 0], g[:, 0, 2] = [2, 1, 0], [0, 0, -1], [9, 9, 9], [7, 7, 7]
    x = np.array([[0, 0, 0], [0.5, 0, 0], [0, 0, 0], [0, 0, -0.25], [1, 1, 1.0]])
    a = fields(
        precision, position=x.T, volume=[0.5, 0.25, 1, 1, 1], mobility=[1.0, 1, 0, 0, 0], solver_pressure=[5000.0, -8, 4, 0, 0],
        pair_gradient=g, velocity=np.zeros((3, 5)), velocity_kept=[[0] * 5, [0] * 5, [9, 9, 9, -0.1, 9]],
    )
    load = run("pressure_load", backend, a, precision, mirror=mirror, dt=0.05, full=full)["body_load"].sum(axis=2)
    deep = 1000 * (9.81 + 0.1 / 0.05) * 0.25  # below the first, and the body moves up ever faster
    deeper = 1000 * ((9.81 + 2) * 0.25 - 0.5) if full == 0 else 0  # the second, also across, has no pressure that it could add to
    first, second = 0.5 * (5000 + mirror * (5000 + deep)), 0.25 * (-8 + mirror * (-8 + deeper))
    assert load[:, 1] == pytest.approx([2 * first, first, -second], rel=1e-6) and not load[:, 0].any()


@everywhere
@both
def test_shear_by_hand(backend, precision):
    w = np.zeros((3, 5, 4))
    w[:, 0, 1], w[:, 0, 0], w[:, 1, 1] = [1, 0, 2], [5, 5, 5], [0, 3, 0]
    a = fields(precision, velocity=np.array([[1, 2, 3], [0, 1, 0], [0, 0, 0], [0, -1, 1], [0, 0, 0.0]]).T, pair_shear=w)
    load = run("shear_load", backend, a, precision)["body_load"].sum(axis=2)
    assert load[:, 1] == pytest.approx([5, 18, 10], rel=1e-6) and not load[:, 0].any()
