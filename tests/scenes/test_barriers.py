"""Boundary points of walls and obstacles: their share of a support, areas, unions; signed distances."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial import cKDTree

from melt.errors import GeometryError, InputError
from melt.geometry.barriers import (
    SIDES,
    Boundary,
    boundary_area,
    mask_boundary,
    obstacle_boundary,
    rectangle_walls,
    union,
)
from melt.geometry.columns import place
from melt.geometry.depth_sums import depth_of, near, weight
from melt.geometry.outlines import area, distance, inside, signed_distance
from melt.geometry.pools import without
from melt.scene.flood_bodies import FloodObstacle, Gauge

H, RATIO = 2.66, 2.66
BOX = FloodObstacle(shape="box", centre=[3, 2], size=[4, 2.2], angle=30)
TOWER = FloodObstacle(shape="cylinder", centre=[1, -2], radius="150 cm")
L_SHAPE = FloodObstacle(shape="polygon", polygon=[[0, 0], [6, 0], [6, 2], [2, 2.3], [2, 5], [0, 5]])
FRAME = FloodObstacle(
    shape="polygon", polygon=[[0, 0], [7, 0.5], [6, 6], [-1, 5]], hole=[[2, 2], [4, 2], [4, 3.5], [2, 3.5]]
)
OUTLINES = {"box": BOX, "cylinder": TOWER, "polygon": L_SHAPE, "frame": FRAME}


def flat(x, y):
    return np.ones_like(x)


def half_plane(s):
    """Share of a kernel of support H beyond a straight line at distance s."""

    def strip(t):
        reach = np.sqrt(max(H * H - t * t, 0.0))
        return 2 * quad(lambda u: weight(np.hypot(t, u), H), 0, reach)[0]

    return quad(strip, s, H)[0]


def share(boundary, areas, points):
    pairs = near(points, boundary.x, np.full(points.shape[1], H))
    return np.bincount(pairs.row, areas[pairs.other] * weight(pairs.r, H), points.shape[1])


@pytest.mark.parametrize(("spacing", "cells", "akinci"), [(0.5, 0.0045, 0.15), (1 / 3, 0.002, 0.15), (0.25, 0.0011, 0.15)])
def test_a_wall_takes_the_share_of_a_half_plane(spacing, cells, akinci):
    """Areas of cells do within the midpoint rule; those of Akinci et al. are too large in the layers at the faces."""
    wall = rectangle_walls((0, 0), (20, 20), ("west",), spacing, H)
    s = np.array([0.02, 0.25, 0.5, 0.8, 1.0, 1.5, 2.0, 2.6])
    exact = np.array([half_plane(d) for d in s])
    for along in (10.0, 10.1):
        points = np.stack([s, np.full(s.size, along)])
        assert np.abs(share(wall, wall.area, points) - exact).max() < cells
        assert (share(wall, boundary_area(wall.x, H), points) - exact).max() > akinci


def test_akincis_areas_are_those_of_cells_only_away_from_the_faces():
    wall = rectangle_walls((0, 0), (20, 20), ("west",), 0.5, 8.0)
    ratio = boundary_area(wall.x, H) / wall.area
    mid = np.abs(wall.x[1] - 10) < 2
    assert ratio[mid & (np.abs(wall.x[0] + 4) < 1)] == pytest.approx(1.0, abs=1e-3)
    assert ratio[mid & (wall.x[0] > -0.3)] == pytest.approx(1.59, abs=0.02)


@pytest.mark.parametrize(
    ("layout", "spacing", "most"), [("equal_mass", 0.5, 0.01), ("equal_area", 0.5, 0.01), ("lattice", 0.5, 0.02), ("lattice", 1.0, 1e-12)]
)
def test_water_at_rest_has_its_depth_beside_a_wall(layout, spacing, most):
    x, V = place(flat, (0, 0), (24, 24), 1.0, layout=layout, reference_depth=1.0)
    walls = rectangle_walls((0, 0), (24, 24), SIDES, spacing, 4.0)
    gap = np.minimum(x, 24 - x)
    row = (gap.min(axis=0) < 1) & (gap.max(axis=0) > 3)
    error = depth_of(x, V, RATIO, (0.5, 13.3), walls)[0] - 1
    assert abs(error[row].mean()) < most
    akinci = Boundary(walls.x, boundary_area(walls.x, H))
    worse = depth_of(x, V, RATIO, (0.5, 13.3), akinci)[0] - 1
    assert worse[row].mean() > 0.09
    assert (depth_of(x, V, RATIO, (0.5, 13.3))[0] - 1)[row].mean() < -0.25


def test_a_wall_on_a_slope_adds_what_its_stage_stands_above_it():
    """Still water on a sloping bed, with the beds of both: the mirrored stage holds, a flat one errs."""
    x, _ = place(flat, (0, 0), (24, 24), 1.0, layout="lattice")
    bed, walls = 0.02 * x[0], rectangle_walls((0, 0), (24, 24), SIDES, 0.5, 4.0)
    V = 1.0 - bed
    row = (x[0] < 1) & (np.abs(x[1] - 12) < 8)
    depth = depth_of(x, V, RATIO, (0.3, 13.3), (*walls, 0.02 * walls.x[0]), bed=bed)[0]
    assert np.abs(depth / V - 1)[row].max() < 0.02
    high = (*walls, np.full(walls.area.size, 5.0))
    alone = depth_of(x, V, RATIO, (0.3, 13.3))[0]
    assert depth_of(x, V, RATIO, (0.3, 13.3), high, bed=bed)[0] == pytest.approx(alone, rel=1e-9)


@pytest.mark.parametrize("sides", [(), ("west",), ("west", "north"), SIDES])
def test_walls_stand_outside_on_their_sides_only(sides):
    walls = rectangle_walls((0, 0), (10, 6.3), sides, 0.5, 2.0)
    x, y = walls.x
    where = {"west": x < 0, "east": x > 10, "south": y < 0, "north": y > 6.3}
    outside = np.any(list(where.values()), axis=0)
    assert outside.all()
    assert {side for side in SIDES if where[side].any()} == set(sides)
    if sides:
        assert cKDTree(walls.x.T).query(walls.x.T, k=2)[0][:, 1].min() > 0.48
    if sides == ("west",):
        assert walls.area.sum() == pytest.approx(6.3 * 2.0) and y.min() > 0 and y.max() < 6.3


def test_bad_walls_are_refused():
    with pytest.raises(InputError, match="left"):
        rectangle_walls((0, 0), (1, 1), ("left",), 0.1, 0.3)
    with pytest.raises(InputError, match="sizes above 0"):
        rectangle_walls((0, 0), (1, 1), SIDES, 0.0, 0.3)


@pytest.mark.parametrize("name", OUTLINES)
@pytest.mark.parametrize("spacing", [0.5, 0.21])
def test_filled_obstacle_has_its_area_and_no_point_outside(name, spacing):
    outline = OUTLINES[name]
    points = obstacle_boundary(outline, spacing, 100.0)
    assert points.area.sum() == pytest.approx(area(outline), rel=0.01)
    assert inside(outline, points.x).all()
    nearest = cKDTree(points.x.T).query(points.x.T, k=2)[0][:, 1]
    assert nearest.min() > 0.4 * spacing and nearest.max() < 1.5 * spacing


@pytest.mark.parametrize("name", OUTLINES)
def test_obstacle_is_as_deep_as_asked_for(name):
    outline = OUTLINES[name]
    points = obstacle_boundary(outline, 0.2, 0.7)
    deep = -distance(outline, points.x)
    assert deep.min() > 0 and deep.max() < 0.7 and deep.max() > 0.5
    everything = obstacle_boundary(outline, 0.2, 100.0)
    assert points.area.size < everything.area.size


@pytest.mark.parametrize("name", OUTLINES)
def test_an_obstacle_takes_the_share_of_its_area(name):
    """Columns beside it see the integral of their kernel over it."""
    outline = OUTLINES[name]
    points = obstacle_boundary(outline, 0.5, 100.0)
    fine = obstacle_boundary(outline, 0.06, 100.0)
    random = np.random.default_rng(0)
    places = random.uniform(-4, 9, (2, 400))
    places = places[:, distance(outline, places) > 0.3]
    error = share(points, points.area, places) - share(fine, fine.area, places)
    assert np.abs(error).max() < 0.015


def test_distance_of_a_box_a_circle_and_a_polygon():
    square = FloodObstacle(centre=[1, 1], size=[2, 4])
    ring = FloodObstacle(shape="polygon", polygon=[[0, -1], [2, -1], [2, 3], [0, 3]])
    nodes = np.array([[1.0, 3.0, 3.0, 1.5, 0.0], [1.0, 1.0, 4.0, 2.9, 1.0]])
    expected = [-1.0, 1.0, np.sqrt(2), -0.1, 0.0]
    assert distance(square, nodes) == pytest.approx(expected)
    assert distance(ring, nodes) == pytest.approx(expected)
    assert distance(TOWER, np.array([[1.0], [2.0]])) == pytest.approx([2.5])
    turned = FloodObstacle(centre=[0, 0], size=[4, 1], angle=90)
    assert distance(turned, np.array([[0.0, 2.0], [1.9, 0.0]])) == pytest.approx([-0.1, 1.5])
    assert distance(FRAME, np.array([[3.0], [2.7]])) == pytest.approx([0.7])  # in the hole: outside


def test_signed_distance_of_several_is_that_to_the_nearest():
    nodes = np.stack([a.ravel() for a in np.meshgrid(np.linspace(-8, 10, 60), np.linspace(-8, 10, 50))])
    whole = signed_distance(OUTLINES.values(), nodes)
    assert whole == pytest.approx(np.min([distance(o, nodes) for o in OUTLINES.values()], axis=0))
    assert ((whole < 0) == np.any([inside(o, nodes) for o in OUTLINES.values()], axis=0)).all()
    assert np.isinf(signed_distance([], nodes)).all()


def test_union_has_no_doubles_and_the_area_of_what_is_covered():
    parts = [(obstacle_boundary(o, 0.25, 100.0), lambda x, o=o: inside(o, x)) for o in (BOX, L_SHAPE, TOWER)]
    walls = rectangle_walls((-6, -6), (10, 10), SIDES, 0.25, 1.0)
    joined = union([(walls, None), *parts, parts[0]], 0.25)
    assert cKDTree(joined.x.T).query(joined.x.T, k=2)[0][:, 1].min() >= 0.1 - 1e-12
    again = union([(walls, None), *parts, parts[0]], 0.25)
    assert (joined.x == again.x).all() and (joined.area == again.area).all()
    random = np.random.default_rng(0).uniform(-6, 10, (2, 200_000))
    covered = (signed_distance([BOX, L_SHAPE, TOWER], random) < 0).mean() * 256
    assert joined.area.sum() - walls.area.sum() == pytest.approx(covered, rel=0.03)
    assert union([], 0.25).x.shape == (2, 0)


def test_blocked_cells_are_filled_to_the_depth_asked_for():
    blocked = np.zeros((20, 30), bool)
    blocked[5:15, 10:24] = True
    points = mask_boundary(blocked, (100.0, 50.0), (1.0, 2.0), 0.5, 100.0)
    assert points.area.sum() == pytest.approx(10 * 14 * 2.0)
    assert points.x.min(axis=1).tolist() == [110.25, 60.25] and points.x.max(axis=1).tolist() == [123.75, 79.75]
    shell = mask_boundary(blocked, (100.0, 50.0), (1.0, 2.0), 0.5, 2.0)
    assert shell.area.sum() < points.area.sum()
    covered = {tuple(p) for p in shell.x.T}
    need = (points.x[0] < 112) | (points.x[0] > 122) | (points.x[1] < 62) | (points.x[1] > 78)
    assert all(tuple(p) in covered for p in points.x[:, need].T)
    assert mask_boundary(np.zeros((3, 3), bool), (0, 0), (1, 1), 0.5, 1.0).x.shape == (2, 0)


@pytest.mark.parametrize("name", OUTLINES)
def test_no_boundary_point_stands_in_the_water_nor_a_column_in_an_obstacle(name):
    outline = OUTLINES[name]
    x, V = place(flat, (-4, -5), (9, 8), 0.5, reference_depth=1.0, region=without([outline]))
    assert (distance(outline, x) > 0).all()
    assert V.sum() == pytest.approx(13 * 13 - area(outline), rel=2e-3)
    points = obstacle_boundary(outline, 0.25, 1.33)
    assert cKDTree(x.T).query(points.x.T)[0].min() > 0.1


def test_a_polygon_without_area_is_refused():
    line = FloodObstacle(shape="polygon", polygon=[[0, 0], [1, 1], [2, 2]])
    with pytest.raises(GeometryError, match="three corners"):
        obstacle_boundary(line, 0.1, 1.0)


@pytest.mark.parametrize(
    ("words", "table"),
    [
        ("needs centre and size", {"shape": "box"}),
        ("not for a cylinder", {"shape": "cylinder", "centre": [0, 0], "radius": 1, "angle": 3}),
        ("needs polygon", {"shape": "polygon"}),
        ("at least 3", {"shape": "polygon", "polygon": [[0, 0], [1, 1]]}),
        ("greater than 0", {"shape": "box", "centre": [0, 0], "size": [0, 1]}),
        ("extra", {"shape": "cylinder", "centre": [0, 0], "radius": 1, "depth": 1}),
        ("shape", {"shape": "sphere", "centre": [0, 0], "radius": 1}),
    ],
)
def test_obstacles_that_make_no_sense_are_refused(words, table):
    with pytest.raises(ValueError, match=words):
        FloodObstacle(**table)


def test_gauge_reads_units():
    assert Gauge(name="A", position=["1 km", 2]).position == [1000.0, 2.0]
