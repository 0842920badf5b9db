"""Pairs of DFSPH: gradients, density ratio and factor by hand, and what the factor is for."""

import numpy as np
import pytest
from dfsph_cases import BACKENDS, D, H, along, arrays, box, run

everywhere = pytest.mark.parametrize("backend", BACKENDS)
both = pytest.mark.parametrize("precision", ("single", "mixed", "double"))
V = D**3
W0, W1 = 20.3718327158, 8.6376570716  # cubic spline at 0 and at r = 0.2, h = 0.5
SLOPE = 8 / (np.pi * H**4) * (12 * 0.4 - 18 * 0.4**2)  # -W'(0.2) = 78.2278: q = 0.4
ALL = ("pair_gradient", "pressure_acceleration", "divergence_source")


def near(precision):
    return dict(rel=1e-10, abs=1e-12) if precision == "double" else dict(rel=2e-5, abs=1e-6)


@everywhere
@both
def test_mobility(backend, precision):
    a = arrays(
        np.zeros((7, 3)), [0, 0, 0, 1, 2, 5, 7], precision, stages=["mobility"], mass=[4, 4, 0, 2, 3, 1, 1],
        held=[0, 1, 0, 0, 0, 0, 0],
    )
    assert run("mobility", backend, a, precision)["mobility"].tolist() == [0.25, 0, 0, 0.5, 0, 0, 0]


@everywhere
@both
def test_two_unequal_particles(backend, precision):
    x = [[1, 1, 1], [1, 1.2, 1]]
    a = arrays(x, 0, precision, stages=ALL, volume=[V, V / 2], mass=[8, 4])
    a["pair_gradient"][:] = -7
    out = run("pair_gradient", backend, a, precision)
    g = out["pair_gradient"]
    assert g[:, 0, 0] == pytest.approx([0, V / 2 * SLOPE, 0], **near(precision))
    assert g[:, 1, 0] == pytest.approx([0, -V * SLOPE, 0], **near(precision))
    assert (g[:, :, 1:] == -7).all()  # behind the count nothing is written
    assert out["density_ratio"] == pytest.approx([V * W0 + V / 2 * W1, V / 2 * W0 + V * W1], rel=2e-5)
    # D_i = (V_i/m_i) |g|^2 + V_i |g|^2 / m_j = V_i g^2 (1/8 + 1/4)
    first, second = V * (V / 2 * SLOPE) ** 2 * 3 / 8, V / 2 * (V * SLOPE) ** 2 * 3 / 8
    assert out["dfsph_factor"] == pytest.approx([1 / first, 1 / second], rel=5e-5)


@everywhere
@both
def test_boundaries_and_what_has_no_pressure(backend, precision):
    # liquid, wall, driven, solid, held liquid, inactive, liquid without mass; the first one is near the next four
    x = [[0, 0, 0], [0.2, 0, 0], [0, 0.2, 0], [-0.2, 0, 0], [0, -0.2, 0], [0, 0, 0.2], [0, 0, -0.2]]
    phase = [0, 2, 7, 1, 0, 5, 0]
    volume, mass = [V, V, V, V, V, 0, 0], [8, 8, 8, 4, 8, 0, 0]
    a = arrays(x, phase, precision, stages=ALL, volume=volume, mass=mass, mobility=[1 / 8, 0, 0, 1 / 4, 0, 0, 0])
    out = run("pair_gradient", backend, a, precision)
    ratio, factor = out["density_ratio"], out["dfsph_factor"]
    assert ratio[0] == pytest.approx(V * (W0 + 4 * W1), rel=2e-5)
    assert ratio[[1, 2, 3, 5]].tolist() == [1, 1, 1, 0]
    assert ratio[6] > 0 and (factor[1:] == 0).all()
    # the gradients cancel; of the four only the solid gives way
    assert factor[0] == pytest.approx(1 / (V * (V * SLOPE) ** 2 / 4), rel=5e-5)
    assert a["neighbour_index"][3, 0] == 0
    assert out["pair_gradient"][:, 3, 0] == pytest.approx([V * SLOPE, 0, 0], **near(precision))


@everywhere
@both
def test_coincident_and_lonely_particles_have_no_factor(backend, precision):
    a = arrays([[0, 0, 0], [0, 0, 0], [9, 9, 9], [20, 0, 0], [20 + H * 0.9999, 0, 0]], 0, precision, stages=ALL)
    out = run("pair_gradient", backend, a, precision)
    assert (out["pair_gradient"][:, :2, 0] == 0).all() and (out["dfsph_factor"] == 0).all()
    assert out["density_ratio"][:3] == pytest.approx([2 * V * W0, 2 * V * W0, V * W0], rel=2e-5)


@everywhere
@both
def test_neighbour_across_a_periodic_face(backend, precision):
    x = [[0.05, 1, 1], [1.85, 1, 1]]
    a = arrays(x, 0, precision, period=(2, 0, 0), stages=ALL)
    out = run("pair_gradient", backend, a, precision, **along("x", 2.0))
    assert out["pair_gradient"][:, 0, 0] == pytest.approx([-V * SLOPE, 0, 0], rel=5e-5, abs=1e-6)
    assert out["density_ratio"] == pytest.approx(V * (W0 + W1), rel=2e-5)


@everywhere
def test_overflowing_list_is_not_read_behind_its_end(backend):
    a = arrays(box(3), 0, stages=ALL)
    a["neighbour_index"] = np.ascontiguousarray(a["neighbour_index"][:, :3])
    a["pair_gradient"] = np.zeros((3, 27, 3))
    assert a["neighbour_count"].min() > 3
    out = run("pair_gradient", backend, a)
    assert np.isfinite(out["pair_gradient"]).all() and np.isfinite(out["density_ratio"]).all()


@everywhere
def test_inside_a_lattice(backend):
    a = arrays(box(7), 0, stages=ALL)
    run("pair_gradient", backend, a)
    centre = 3 * 49 + 3 * 7 + 3
    assert a["density_ratio"][centre] == pytest.approx(0.9985, abs=1e-4)
    count = a["neighbour_count"][centre]
    assert np.abs(a["pair_gradient"][:, centre, :count].sum(axis=1)).max() < 1e-12


@everywhere
def test_in_the_plane_per_metre_of_depth(backend):
    a = arrays([[0, 0, 0], [0.2, 0, 0]], 0, stages=ALL, volume=D**2, mass=1000 * D**2)
    out = run("pair_gradient", backend, a, dimension=2)
    s = 40 / (7 * np.pi * H**2)
    w1 = s * (6 * 0.4**3 - 6 * 0.4**2 + 1)
    assert out["density_ratio"] == pytest.approx(D**2 * (s + w1), rel=1e-10)
    assert out["pair_gradient"][0, 0, 0] == pytest.approx(D**2 * s / H * (12 * 0.4 - 18 * 0.4**2), rel=1e-10)


@everywhere
def test_factor_is_the_pressure_that_cancels_a_density_error(backend):
    """Of one pressure alone the density ratio of its particle changes by -p/alpha dt^2, in any surroundings."""
    rng = np.random.default_rng(2)
    x = box(4) + rng.uniform(-0.04, 0.04, (64, 3))
    phase = rng.choice([0, 1, 2, 7], 64, p=[0.6, 0.1, 0.2, 0.1])
    a = arrays(x, phase, stages=(*ALL, "pressure_acceleration"), volume=V * rng.uniform(0.5, 1.5, 64), mass=rng.uniform(2, 9, 64))
    run("pair_gradient", backend, a)
    for i in np.flatnonzero(a["dfsph_factor"])[::5]:
        a["solver_pressure"] = np.where(np.arange(64) == i, 3e3, 0.0)
        run("pressure_acceleration", backend, a)
        a["velocity"] = a["pressure_acceleration"]
        change = run("divergence_source", backend, a, dt=1.0)["compression_source"][i]
        assert change == pytest.approx(-3e3 / a["dfsph_factor"][i], rel=1e-10)


@everywhere
@pytest.mark.parametrize("n", (0, 1))
def test_few_particles(backend, n):
    a = arrays(np.zeros((n, 3)), 0, stages=ALL)
    out = run("pair_gradient", backend, a)
    assert out["density_ratio"] == pytest.approx(np.full(n, V * W0)) and (out["dfsph_factor"] == 0).all()
