"""Analytic beds against values that the flood spec and the literature give."""

import numpy as np
import pytest
from terrain_files import terrain

from melt.geometry.terrain_shapes import SHAPES, macdonald_depth, parameters, sample


def line(name, x, **given):
    return sample(name, x, [0.0], given)[0]


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_is_finite_and_has_the_shape_of_its_nodes(name):
    x, y = np.linspace(-30, 130, 33), np.linspace(-20, 40, 1030)  # more rows than one block
    z = sample(name, x, y, {})
    assert z.shape == (1030, 33) and z.dtype == np.float64 and np.isfinite(z).all()
    assert (z[::7, ::3] == sample(name, x[::3], y[::7], {})).all()  # a function of the place, not of the grid
    assert SHAPES[name].__doc__ and all(default is not ... for default in parameters(name).values())


def test_a_grid_samples_a_shape_at_cell_centres():
    grid = terrain(
        shape="bowl", parameters={"depth": "10 cm", "centre": [2, 2]}, cell=[0.5, 0.25], lower=[0, 0], upper=[4, 4]
    )
    x, y = np.meshgrid(grid.x, grid.y)
    assert grid.shape == (16, 8) and grid.lower == (0.25, 0.125) and grid.bounds.tolist() == [[0, 0], [4, 4]]
    expected = -0.1 * (1 - (x - 2) ** 2 - (y - 2) ** 2)
    assert grid.elevation + grid.datum == pytest.approx(expected, abs=1e-12)
    assert grid.datum == expected.min() and grid.crs is None


def test_an_extent_is_whole_cells():
    grid = terrain(shape="flat", cell=1.0, lower=[0, 0], upper=[10.4, 9.6])
    assert grid.shape == (10, 10) and any("upper is (10, 10)" in note for note in grid.notes)


def test_planes_and_steps():
    assert line("plane", [0.0, 10.0], slope=0.1, height=2.0) == pytest.approx([2, 1])
    north = sample("plane", [0.0, 5.0], [0.0, 10.0], {"slope": 0.1, "direction": 90.0})
    assert north.tolist() == [[0, 0], [-1, -1]]
    assert line("step", [-1, 0, 1], height=0.3).tolist() == [0, 0.3, 0.3]
    assert line("cliff", [-1, 0, 2.5, 5, 9], run=5.0).tolist() == [10, 10, 5, 0, 0]
    assert line("slope_then_plain", [-10.0, 0.0, 5.0]).tolist() == [1, 0, 0]


def test_bumps_and_bowls():
    assert line("bump", [7.9, 8.0, 9.0, 10.0, 12.1]) == pytest.approx([0, 0, 0.15, 0.2, 0])
    assert line("smooth_bump", [7.9, 8.0, 9.0, 10.0, 12.1]) == pytest.approx([0, 0, 0.1, 0.2, 0])
    assert line("bowl", [0.0, 1.0, 2.0], dimension=1) == pytest.approx([-0.1, 0, 0.3])
    assert sample("bowl", [1.0], [1.0], {}) == pytest.approx(0.1)
    assert line("pit", [0.0, 2.5, 5.0, 9.0]) == pytest.approx([-2, -1, 0, 0])


def test_flume_and_basin():
    assert line("sill", [25.0, 25.5, 27.0, 28.5, 30.0, 31.5, 38.0]) == pytest.approx([0, 0, 0.2, 0.4, 0.2, 0, 0])
    assert line("beach", [-19.85, 0.0, 19.85, 30.0]) == pytest.approx([1, 0, -1, -1])
    x = 12.96 + np.array([0, 1.1, 1.1 + 1, 3.6, 5])
    cone = sample("cone", x, [13.8], {})[0]
    assert cone == pytest.approx([0.625, 0.625, 0.375, 0, 0])  # slope 1:4
    assert (cone == sample("cone", x, [13.8], {"slope": 0.25})[0]).all()


def test_macdonald_channel():
    """Values of the flood spec, section 6."""
    x = np.array([0, 25, 50, 66, 67, 80, 100.0])
    assert macdonald_depth(x)[0] == pytest.approx([0.98871, 0.89708, 0.69294, 0.50326, 1.09640, 2.20873, 2.87871], abs=1e-5)
    bed = line("macdonald", x)
    assert bed == pytest.approx([2.59561, 2.51508, 2.31657, 1.72831, 1.65364, 0.65629, 0], abs=1.5e-5)
    # its slope balances friction and the change of head, on both sides of the jump
    for at in (20.0, 60.0, 70.0, 95.0):
        d, d_x = macdonald_depth(at)
        slope = (4 / (9.81 * d**3) - 1) * d_x - (0.0328 * 2) ** 2 / d ** (10 / 3)
        ends = line("macdonald", [at - 1e-3, at + 1e-3])
        assert (ends[1] - ends[0]) / 2e-3 == pytest.approx(slope, rel=1e-5)
    assert line("macdonald", [-5.0, 105.0]) == pytest.approx([bed[0], 0])


def test_noise_is_the_same_for_a_seed_only():
    x = np.arange(200.0)
    a, b = (sample("noise", x, x, {"seed": s}) for s in (1, 2))
    assert (a == sample("noise", x, x, {"seed": 1})).all() and np.abs(a - b).max() > 0.3
    assert 0.3 < np.abs(a).max() <= 1
    rough = [np.abs(np.diff(sample("noise", x, x, {"roughness": r}))).mean() for r in (0.3, 0.7)]
    assert rough[1] > 1.5 * rough[0]
    assert a[3, 5] == pytest.approx(0.04009971972108155, abs=1e-12)  # on every machine


def test_a_valley_has_a_bed_that_falls_and_flanks_that_rise():
    x, y = np.linspace(0, 4000, 81), np.linspace(-2000, 2000, 161)
    z = sample("valley", x, y, {})
    bed = z.min(axis=0)
    assert bed == pytest.approx(-0.005 * x, abs=0.5)
    assert (np.abs(y[z.argmin(axis=0)]) <= 225).all()
    assert (z[[0, -1]] > bed + 20).all()
