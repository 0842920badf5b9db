"""Depth at points of a map and at gauges, and what is kept of it."""

import numpy as np
import pytest
from flood_motion_cases import AIRBORNE, INACTIVE, LIQUID, arrays, run
from liquid_cases import BACKENDS, REALS, everywhere


def W(r, h):
    """The cubic spline of flood spec 0, with l = h/2."""
    q = 2 * np.asarray(r, float) / h
    return 40 / (7 * np.pi * h**2) * np.where(q < 1, 1 - 1.5 * q**2 + 0.75 * q**3, 0.25 * np.maximum(2 - q, 0) ** 3)


def lake(spacing, width=6.0, height=5.0, level=1.0, slope=0.0, **fields):
    """Columns on a lattice over the grid of 6 x 5 cells, in cell order: bed slope x, surface ``level``."""
    k = int(width / spacing)
    x, y = np.meshgrid((np.arange(k) + 0.5) * spacing, (np.arange(int(height / spacing)) + 0.5) * spacing, indexing="xy")
    x, y = x.ravel(), y.ravel()
    order = np.lexsort([np.floor(x), np.floor(y)])
    x, y = x[order], y[order]
    b = slope * x
    d = level - b
    given = dict(bed=b, depth=d, rest_volume=d * spacing**2, support_radius=np.full(len(x), 2.66 * spacing))
    return arrays(np.column_stack([x, y, np.full(len(x), level)]), search=True, **{**given, **fields})


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_one_column_by_hand(backend, precision):
    """Between two columns: means weighted with A W; cover and conservative depth are plain sums."""
    V, d, b, h = np.array([2.0, 3.0]), np.array([2.0, 1.5]), np.array([0.5, 1.5]), np.array([1.5, 2.0])
    v = np.array([[3.0, 0], [4.0, 1.0], [9.0, 9.0]])
    a = arrays(
        [[1, 1, 0], [1.5, 1, 0]], LIQUID, precision, search=True, rest_volume=V, depth=d, bed=b, support_radius=h, velocity=v,
        sample_position=[[1.25, 2.75], [1.0, 1.0]], sample_bed=[0.25, 0.25],
    )
    run("flood_sample", backend, a, cover=0.1)
    w = W([0.25, 0.25], h)
    cover = (V / d * w).sum()
    eta, speed = (V / d * w * (b + d)).sum() / cover, (V / d * w * [5.0, 1.0]).sum() / cover
    rel = 1e-12 if precision == "double" else 2e-6
    got = [a[f"sample_{k}"][0] for k in ("surface", "depth", "column", "speed")]
    assert got == pytest.approx([eta, eta - 0.25, (V * w).sum(), speed], rel=rel)
    # 1.75 m from the first (beyond h), 1.25 m from the second
    assert a["sample_column"][1] == pytest.approx(3 * W(1.25, 2.0), rel=10 * rel)


@everywhere
def test_too_little_cover_is_dry(backend):
    """A lone column of 0.2 m^2 covers 0.2 W: dry, but its volume counts."""
    a = arrays([[1, 1, 0]], search=True, rest_volume=[0.2], support_radius=[2.0], sample_position=[[1.0], [1.0]], sample_bed=[0.5])
    run("flood_sample", backend, a)
    assert [a[f"sample_{k}"][0] for k in ("surface", "depth", "speed")] == [0.5, 0, 0]
    assert a["sample_column"][0] == pytest.approx(0.2 * W(0, 2.0), rel=1e-12)


@everywhere
def test_ground_above_the_surface_is_dry(backend):
    a = lake(0.5, velocity=np.ones((3, 120)), sample_position=[[3.0, 3.1], [2.5, 2.5]], sample_bed=[2.0, 0.9])
    run("flood_sample", backend, a)
    assert a["sample_depth"] == pytest.approx([0, 0.1], abs=1e-12) and a["sample_surface"] == pytest.approx([2, 1])
    assert a["sample_speed"] == pytest.approx([0, np.sqrt(2)])


@everywhere
def test_a_level_lake_is_level_whatever_its_bed(backend):
    """The weighted surface of a lake is exact; the conservative depth has the error of the kernel sum."""
    x, y = np.linspace(1, 5, 9), np.linspace(1, 4, 9)
    a = lake(0.25, slope=0.1, sample_position=[x, y], sample_bed=0.1 * x)
    run("flood_sample", backend, a)
    assert a["sample_surface"] == pytest.approx(np.ones(9), rel=1e-12)
    assert a["sample_depth"] == pytest.approx(1 - 0.1 * x, rel=1e-12)
    assert a["sample_column"] == pytest.approx(1 - 0.1 * x, rel=5e-3)


@everywhere
def test_the_conservative_depth_holds_the_volume(backend):
    """Its integral over a fine map is the volume: of a patch of columns, and of one alone."""
    step = 0.05
    x, y = (g.ravel() for g in np.meshgrid(np.arange(0, 6, step), np.arange(0, 5, step)))
    a = arrays(
        [[2, 2, 0], [2.5, 2, 0], [3.25, 2.5, 0]], search=True, rest_volume=[0.3, 0.5, 0.2], support_radius=[1.0, 1.5, 1.25],
        sample_position=[x, y], sample_bed=np.zeros(len(x)),
    )
    run("flood_sample", backend, a)
    assert a["sample_column"].sum() * step**2 == pytest.approx(1.0, rel=1e-5)


@everywhere
def test_only_water_counts_and_nan_of_a_slot_does_not(backend):
    """Free slots and falling columns hold anything."""
    a = arrays(
        [[1, 1, 0], [1.25, 1, 0], [1.25, 1, 0]], [LIQUID, AIRBORNE, INACTIVE], search=True, depth=[1, 0, np.nan],
        rest_volume=[2, 5, np.nan], velocity=[[1, np.nan, 9], [0, 0, 9], [0, 0, 9]], sample_position=[[1.0], [1.0]], sample_bed=[0.0],
    )
    run("flood_sample", backend, a)
    assert a["sample_surface"][0] == pytest.approx(1) and a["sample_speed"][0] == pytest.approx(1)


@everywhere
def test_nan_of_the_water_shows(backend):
    a = arrays([[1, 1, 0]], search=True, depth=[np.nan], rest_volume=[2], sample_position=[[1.0], [1.0]], sample_bed=[0.0])
    run("flood_sample", backend, a)
    assert np.isnan(a["sample_surface"][0]) and np.isnan(a["sample_depth"][0])


@everywhere
def test_points_beyond_the_grid_see_what_is_near_them(backend):
    point = dict(sample_position=[[8.25, 30], [2.0, 2]], sample_bed=[0.0, 0.0])
    a = arrays([[8.0, 2, 0]], search=True, rest_volume=[4], support_radius=[1.5], **point)
    run("flood_sample", backend, a)
    assert a["sample_depth"] == pytest.approx([1, 0])


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_most_arrival_and_duration_by_hand(backend, precision):
    """Deeper than 0.05 m counts as reached, once; what was larger before stays."""
    a = arrays(
        np.zeros((0, 3)), LIQUID, precision, sample_position=np.zeros((2, 4)),
        sample_depth=[0.5, 0.04, 0.25, 0.0], sample_speed=[2, 3, 1, 0], most_depth=[0.25, 0, 1, 1], most_speed=[1, 1, 4, 1],
        most_flux=[0.5, 0, 0.5, 1], arrival_time=[-1, -1, 2, -1], wet_time=[0, 1, 2, 3],
    )
    run("keep_most", backend, a, time=6.0, dt=0.5)
    rel = 1e-14 if precision == "double" else 1e-6
    assert a["most_depth"] == pytest.approx([0.5, 0.04, 1, 1], rel=rel) and a["most_speed"].tolist() == [2, 3, 4, 1]
    assert a["most_flux"] == pytest.approx([1, 0.12, 0.5, 1], rel=rel)
    assert a["arrival_time"].tolist() == [6, -1, 2, -1] and a["wet_time"].tolist() == [0.5, 1, 2.5, 3]
    run("keep_most", backend, a, time=7.0, dt=0.5)
    assert a["arrival_time"].tolist() == [6, -1, 2, -1] and a["wet_time"].tolist() == [1, 1, 3, 3]


@pytest.mark.parametrize("backend", BACKENDS)
def test_nothing_is_fine(backend):
    a = arrays(np.zeros((0, 3)), search=True, sample_position=[[1.0], [1.0]], sample_bed=[0.5])
    run("flood_sample", backend, a)
    assert [a[f"sample_{k}"][0] for k in ("surface", "depth", "column", "speed")] == [0.5, 0, 0, 0]
    most = {k: np.zeros(0) for k in ("most_depth", "most_speed", "most_flux", "arrival_time", "wet_time")}
    a = arrays([[1, 1, 0]], search=True, sample_position=np.zeros((2, 0)), **most)
    run("flood_sample", backend, a)
    run("keep_most", backend, a, time=1.0, dt=0.1)
