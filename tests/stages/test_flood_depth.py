"""Depth and support of columns: lattices, walls, clamps, and what must not hide (flood E3, E4, E8, E9, E14)."""

import numpy as np
import pytest
from flood_cases import AIRBORNE, EXCESS, INACTIVE, LIQUID, RATIO, arrays, kernel, lattice, run
from liquid_cases import BACKENDS, REALS, both, everywhere

from melt import params as P

KINDS = ("square", "hexagonal")
CENTRE = 17 * 8 + 8  # of `lattice` with half = 8


def rel(precision):
    return 1e-12 if precision == "double" else 3e-6


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_two_columns_by_hand(backend, precision):
    """The paper's order (no iterations): both depths at the old supports, supports from them."""
    V, h = np.array([1.0, 0.7]), np.array([2.0, 2.5])
    a = arrays([[0, 0], [0.75, 1.0]], V, h, precision=precision)  # 1.25 m apart
    run("flood_depth", backend, a, iterations=0)
    d = V * kernel(0.0, h) + V[::-1] * kernel(1.25, h)
    assert a["depth"] == pytest.approx(d, rel=rel(precision))
    assert a["support_radius"] == pytest.approx(np.minimum(RATIO * np.sqrt(V / d), 1.1 * h), rel=rel(precision))
    assert a["depth_state"].tolist() == [8, 8]  # two columns are fewer than three neighbours


@everywhere
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("wendland", (P.CUBIC, P.WENDLAND2))
def test_lattice_has_the_printed_excess_and_none_with_the_normalisation(backend, kind, wendland):
    excess = EXCESS[wendland, kind]
    a = arrays(lattice(kind), 0.5)  # half a metre deep
    run("flood_depth", backend, a, iterations=0, kernel=wendland)
    beta = a["depth"][CENTRE] / 0.5 - 1
    assert beta == pytest.approx(excess, abs=6e-5)
    a = arrays(lattice(kind), 0.5)
    run("flood_depth", backend, a, kernel=wendland, sigma=1 / (1 + beta))
    assert a["depth"][CENTRE] == pytest.approx(0.5, rel=1e-12)
    assert a["support_radius"][CENTRE] == pytest.approx(RATIO, rel=1e-12)
    assert a["support_factor"][CENTRE] == pytest.approx(1, abs=0.06)
    assert a["depth_state"][CENTRE] == 0


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_solution_satisfies_both_equations_whatever_the_first_support(backend, precision):
    """d = sum V W(h) and d h^2 = ratio^2 V, from supports off by 9 % either way; Omega by a finite difference."""
    rng = np.random.default_rng(2)
    x = lattice("hexagonal") + rng.uniform(-0.25, 0.25, (17 * 17, 2))
    V = rng.uniform(0.5, 1.5, len(x))
    a = arrays(x, V, RATIO * rng.uniform(0.92, 1.09, len(x)), precision=precision, growth=1.6)
    run("flood_depth", backend, a, iterations=6, tolerance=1e-12 if precision == "double" else 1e-6, growth=1.6)
    d, h, omega = (a[k].astype(float) for k in ("depth", "support_radius", "support_factor"))
    inner = np.flatnonzero((np.abs(x) < 4).all(axis=1))
    assert len(inner) > 40 and (a["depth_state"][inner] == 0).all()
    r = np.hypot(*(x[inner, None] - x[None]).transpose(2, 0, 1))
    tolerance = 1e-11 if precision == "double" else 5e-6
    assert d[inner] == pytest.approx((V * kernel(r, h[inner, None])).sum(axis=1), rel=tolerance)
    assert d[inner] * h[inner] ** 2 == pytest.approx(RATIO**2 * V[inner], rel=tolerance)
    # Omega = 1 - dS/dh dh/dd = 1 + h/(2d) dS/dh
    e = 1e-5 * h[inner, None]
    slope = ((V * kernel(r, h[inner, None] + e)).sum(axis=1) - (V * kernel(r, h[inner, None] - e)).sum(axis=1)) / (2 * e[:, 0])
    assert omega[inner] == pytest.approx(1 + h[inner] / (2 * d[inner]) * slope, rel=1e-7 if precision == "double" else 1e-4)


@everywhere
def test_support_follows_a_lattice_that_spreads(backend):
    """Spacing 1.05: the same lattice, 1/1.05^2 as deep and 1.05 times as wide; h^2 d stays."""
    a = arrays(1.05 * lattice("square"), 1.0, RATIO)
    run("flood_depth", backend, a)
    assert a["depth"][CENTRE] == pytest.approx((1 + EXCESS[P.CUBIC, "square"]) / 1.05**2, rel=1e-3)
    assert a["support_radius"][CENTRE] == pytest.approx(1.05 * RATIO, rel=1e-3)


@everywhere
@both
def test_isolated_column_grows_to_its_largest_support(backend, precision):
    """h = 5 h_0 and d = 0.0103 V/r_0^2 in the end, Omega 1; until then it grows by 10 % in a sub-step."""
    a = arrays([[3.0, 2.0]], 2.0, precision=precision)
    for k in range(1, 18):
        run("flood_depth", backend, a, iterations=3, tolerance=1e-6)
        h = RATIO * min(1.1**k, 5)
        assert a["support_radius"][0] == pytest.approx(h, rel=1e-5)
        assert a["depth"][0] == pytest.approx(2 * kernel(0.0, h), rel=3e-5)
        assert a["support_factor"].tolist() == [1] and a["depth_state"].tolist() == [8 if k < 17 else 9]
    assert a["depth"][0] == pytest.approx(2 * 0.0103, rel=3e-3)


@everywhere
def test_crowd_stops_at_the_smallest_support(backend):
    a = arrays(0.05 * lattice("square", 3), 1.0, 0.7)
    run("flood_depth", backend, a)
    middle = 7 * 3 + 3
    h = 0.25 * RATIO
    assert a["support_radius"][middle] == h and a["support_factor"][middle] == 1 and a["depth_state"][middle] == 2
    r = np.hypot(*(0.05 * lattice("square", 3)).T)
    assert a["depth"][middle] == pytest.approx(kernel(r, h).sum(), rel=1e-12)


@everywhere
def test_too_few_iterations_are_reported(backend):
    a = arrays(lattice("square", 4), 1.0, 1.05 * RATIO)
    run("flood_depth", backend, a, iterations=1, tolerance=1e-6)
    assert a["depth_state"][40] == 4
    run("flood_depth", backend, a, iterations=4, tolerance=1e-6)
    assert a["depth_state"][40] == 0


def shore(depth, z=0.0, spacing=0.5, rows=12):
    """Columns at x > 0 and boundary particles at x < 0 of a bed at height z there; returns both."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(6), np.arange(-8, 9)))
    x = np.column_stack([i + 0.5, j])
    i, j = (a.ravel() for a in np.meshgrid(np.arange(rows), np.arange(-24, 25)))
    wall = np.column_stack([-(i + 0.5) * spacing, j * spacing, np.full(i.size, z), np.full(i.size, spacing**2)])
    return x, wall, 6 * 8  # the column at (0.5, 0)


@everywhere
@both
@pytest.mark.parametrize("depth", [0.2, 1.0, 5.0])
def test_wall_that_mirrors_the_stage_keeps_the_depth(backend, precision, depth):
    """Beside a wall the depth is that of the water at any depth; without the wall a quarter is missing.

    Within 1 % in the second row of columns; in the first, half a spacing from the wall, the sum over a coarse
    lattice that ends there and a fine one that starts is off by 1.8 %; walls as coarse as the columns have no error.
    """
    x, wall, edge = shore(depth)
    a = arrays(x, depth, precision=precision, walls=wall)
    run("flood_depth", backend, a, tolerance=1e-6)
    assert a["depth"][edge] == pytest.approx(depth, rel=0.02)
    assert a["depth"][edge + 1] == pytest.approx(depth, rel=0.01)
    assert a["support_factor"][edge] == pytest.approx(1, abs=0.02)
    x, wall, edge = shore(depth, spacing=1.0)
    a = arrays(x, depth, precision=precision, walls=wall)
    run("flood_depth", backend, a, tolerance=1e-6)
    assert a["depth"][edge] == pytest.approx(depth, rel=1e-3)
    b = arrays(x, depth, precision=precision)
    run("flood_depth", backend, b, iterations=0)
    assert b["depth"][edge] < 0.77 * depth


@everywhere
def test_wall_of_the_paper_adds_what_is_missing_to_one_metre(backend):
    """psi_b = rho_0 V_b: the share gamma of the kernel beyond the wall counts as 1 m deep."""
    for depth in (0.2, 5.0):
        x, wall, edge = shore(depth)
        a = arrays(x, depth, walls=wall)
        run("flood_depth", backend, a, iterations=0, wall_mirror=0)
        r = np.hypot(wall[:, 0] - 0.5, wall[:, 1])
        gamma = (wall[:, 3] * kernel(r, RATIO)).sum()
        assert 0.25 < gamma < 0.4
        assert a["depth"][edge] == pytest.approx(depth + gamma * (1 - depth), rel=0.02)


@everywhere
@both
def test_wall_above_the_water_is_dry_and_one_below_the_bed_carries_more(backend, precision):
    x, wall, edge = shore(1.0, z=1.5)
    a = arrays(x, 1.0, precision=precision, walls=wall)
    run("flood_depth", backend, a, tolerance=1e-6)
    b = arrays(x, 1.0, precision=precision)
    run("flood_depth", backend, b, tolerance=1e-6)
    assert a["depth"][edge] == b["depth"][edge] and a["support_factor"][edge] == b["support_factor"][edge]
    x, wall, edge = shore(1.0, z=-0.5)
    c = arrays(x, 1.0, precision=precision, walls=wall, bed=np.zeros(len(x)))
    run("flood_depth", backend, c, iterations=0)
    r, r_b = np.hypot(*(x - x[edge]).T), np.hypot(*(wall[:, :2] - x[edge]).T)
    S, gamma = kernel(r, RATIO).sum(), (wall[:, 3] * kernel(r_b, RATIO)).sum()
    assert c["depth"][edge] == pytest.approx((S + 0.5 * gamma) / (1 - gamma), rel=3e-6)


@everywhere
def test_column_in_a_cup_of_walls_is_bounded(backend):
    """gamma near 1: its share is cut so that 1 - gamma = 0.3, and d = V W(0)/0.3."""
    wall = np.column_stack([0.25 * (lattice("square", 14) + 0.5), np.zeros(29 * 29), np.full(29 * 29, 0.0625)])
    a = arrays([[0.0, 0.0]], 1.0, walls=wall, growth=1.1)
    run("flood_depth", backend, a, iterations=0)
    assert a["depth"][0] == pytest.approx(kernel(0.0, RATIO) / 0.3, rel=1e-12)


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_coincident_columns_are_alike(backend, precision):
    x = lattice("square", 4)
    a = arrays(np.vstack([x, x[40]]), 1.0, precision=precision)
    run("flood_depth", backend, a, tolerance=1e-6)
    assert np.isfinite(a["depth"]).all() and a["depth"][40] > 1.1
    assert a["depth"][81] == pytest.approx(a["depth"][40], rel=1e-6)


@everywhere
def test_what_is_no_number_shows_and_stays_where_it_is(backend):
    """A volume that is NaN spoils those who see it; a place that is NaN is nobody's neighbour."""
    x = lattice("square", 5)
    bad = np.ones(121)
    bad[60] = np.nan
    a = arrays(x, bad)
    run("flood_depth", backend, a)
    assert np.isnan(a["depth"][[60, 61, 62]]).all() and np.isfinite(a["depth"][[0, 10, 110, 120]]).all()
    assert np.isfinite(a["support_radius"]).all()  # a search stays bounded
    x[60] = np.nan
    a = arrays(x, 1.0)
    run("flood_depth", backend, a)
    assert np.isfinite(a["depth"]).all() and a["depth_state"][60] == 8
    b = arrays(np.delete(x, 60, axis=0), 1.0)
    run("flood_depth", backend, b)
    assert np.delete(a["depth"], 60) == pytest.approx(b["depth"], rel=1e-14)


@everywhere
@both
def test_falling_columns_see_the_water_under_them_and_waiting_ones_nothing(backend, precision):
    x = np.vstack([lattice("square", 5), [[0.25, 0.5], [0.25, 0.5], [50.0, 50.0]]])
    phase = np.append(np.full(121, LIQUID), [AIRBORNE, INACTIVE, AIRBORNE])
    h = np.append(np.full(121, RATIO), [2.0, 2.0, 2.0])
    a = arrays(x, 1.0, h, phase, precision)
    run("flood_depth", backend, a, tolerance=1e-6)
    r = np.hypot(*(x[:121] - x[121]).T)
    assert a["depth"][121] == pytest.approx(kernel(r, 2.0).sum(), rel=3e-6)
    assert a["depth"][122:].tolist() == [0, 0]
    assert (a["support_radius"][121:] == 2).all() and (a["support_factor"][121:] == 1).all() and (a["depth_state"][121:] == 0).all()
    b = arrays(x[:121], 1.0, precision=precision)
    run("flood_depth", backend, b, tolerance=1e-6)
    assert (a["depth"][:121] == b["depth"]).all(), "they are in nobody's sum"


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_surface_is_bed_plus_depth_of_columns_of_water(backend, precision):
    phase = [LIQUID, AIRBORNE, INACTIVE]
    a = arrays(np.zeros((3, 2)), 1.0, 1.0, phase, precision, bed=[3.5, 1, 1], depth=[0.25, 1, 1])
    a["position"][2] = 9
    run("flood_surface", backend, a)
    assert a["position"][2].tolist() == [3.75, 9, 9]


@pytest.mark.parametrize("backend", BACKENDS)
def test_no_column_at_all(backend):
    a = arrays(np.zeros((0, 2)))
    assert run("flood_depth", backend, a)["depth"].shape == (0,)
    run("flood_surface", backend, a)
