"""Initial states: the paper's counts, walls, removal of overlaps, sites, materials, inflow."""

import pathlib

import numpy as np
import pytest
from scipy.spatial import cKDTree

from melt.errors import GeometryError, SceneError
from melt.fields import FIELDS
from melt.geometry.build import build
from melt.geometry.nozzles import disc
from melt.scene import load_scene, scene_from_dict, shipped_scenes


def scene(**sections):
    data = {"time": {"end": 1.0}, "domain": {"upper": [2, 2, 2], "spacing": 0.2}, **sections}
    return scene_from_dict(data)


WATER = {"fill": [{"lower": [0, 0, 0], "upper": [2, 2, 1]}]}


@pytest.mark.parametrize(
    ("name", "liquid", "solids", "inactive"),
    [
        ("ice_cube", 35000, [4913], 0),
        ("four_densities", 48488, [3000] * 4, 0),
        ("two_jets", 0, [5000] * 4, 40500),
        ("dam_break", 6400, [], 0),
        ("tank", 2000, [], 0),
        ("stefan_front", 10240, [10240], 0),
    ],
)
def test_paper_scene_has_the_papers_counts(name, liquid, solids, inactive):
    initial = build(load_scene(name))
    counts = initial.counts
    assert (counts["liquid"], counts["inactive"]) == (liquid, inactive)
    found = np.bincount(initial["site_body"], minlength=len(solids))
    if name == "two_jets":  # meshes: within 2 % of the wanted count
        assert (np.abs(found - solids) <= 0.02 * np.array(solids)).all()
        assert [n.count for n in initial.nozzles] == [81, 81]
        assert [n.layers for n in initial.nozzles] == [250, 250]
    else:
        assert found.tolist() == solids


def built(name):
    """Return the initial state of a shipped scene; measured data that are not here skip the test."""
    scene = load_scene(name)
    file = scene.terrain.file if scene.kind == "flood" else None
    if file is not None and not pathlib.Path(file).is_file():
        pytest.skip(f"{file} is not here (MELT_DATA)")
    return build(scene)


@pytest.mark.parametrize("name", [n for n in sorted(shipped_scenes()) if load_scene(n).kind == "flood"])
def test_columns_of_a_shipped_flood_stand_apart_and_on_the_terrain(name):
    initial = built(name)
    x = initial["position"][:2, : initial.active].T
    assert (x >= initial.domain_lower[:2]).all() and (x <= initial.domain_upper[:2]).all()
    if len(x):
        near = cKDTree(x).query(x, k=2)[0][:, 1]
        own = initial["support_radius"][: initial.active] / load_scene(name).solver.support
        assert (near > 0.15 * own).all() and np.quantile(near / own, 0.01) > 0.5


@pytest.mark.parametrize("name", [n for n in sorted(shipped_scenes()) if load_scene(n).kind == "liquid"])
def test_shipped_scene_places_no_two_particles_closer_than_a_spacing(name):
    scene = load_scene(name)
    initial = build(scene)
    x = initial["position"][:, : initial.active].T
    nearest = 0.999 - 2 * np.sqrt(2) * scene.fluid.jitter  # both of a pair moved towards each other along a diagonal
    assert len(cKDTree(x).query_pairs(nearest * initial.spacing)) == 0
    inside = initial["phase"][: initial.active] != 2
    assert (x[inside] > initial.domain_lower).all() and (x[inside] < initial.domain_upper).all()


@pytest.mark.parametrize("name", [n for n in shipped_scenes() if n.endswith("_small")])
def test_small_scene_is_small(name):
    counts = build(load_scene(name)).counts
    assert 500 <= counts["liquid"] + counts["solid"] + counts["inactive"] <= 3000


@pytest.mark.parametrize("name", sorted(shipped_scenes()))
def test_arrays_have_the_shapes_of_the_field_table(name):
    initial = built(name)
    extents = {}
    for field, values in initial.arrays.items():
        shape = FIELDS[field].shape
        assert values.dtype == (np.int32 if FIELDS[field].kind == "int" else np.float64), field
        assert len(shape) == values.ndim, field
        for extent, size in zip(shape, values.shape):
            assert size == (int(extent) if extent.isdigit() else extents.setdefault(extent, size)), (
                field,
                extent,
            )
        if FIELDS[field].kind != "int" and field != "material_melting_point":
            assert np.isfinite(values).all(), field


def test_particles_stand_at_cell_centres_with_the_mass_of_their_cell():
    initial = build(scene(fluid={**WATER, "density": 800}))
    liquid = initial["phase"] == 0
    cells = initial["position"][:, liquid] / 0.2 - 0.5
    assert np.abs(cells - cells.round()).max() < 1e-9
    assert initial["mass"][liquid].sum() == pytest.approx(800 * 2 * 2 * 1)


def test_walls_are_three_layers_on_floor_and_sides_and_open_above():
    initial = build(scene())
    x = initial["position"][:, initial["phase"] == 2]
    assert initial.counts["wall"] == 16 * 16 * 13 - 10**3
    assert x.min() == pytest.approx(-0.5) and x[2].max() == pytest.approx(1.9)
    assert (
        build(scene(domain={"upper": [2, 2, 2], "walls": {"sides": "all"}})).counts["wall"] == 16**3 - 10**3
    )
    assert build(scene(domain={"upper": [2, 2, 2], "walls": {"sides": "none"}})).counts["wall"] == 0
    assert build(scene(domain={"upper": [2, 2, 2], "walls": {"sides": "floor"}})).counts["wall"] == 300
    low = build(scene(domain={"upper": [2, 2, 2], "walls": {"height": 1.0}})).counts["wall"]
    assert low == 16 * 16 * 8 - 10 * 10 * 5


def test_liquid_in_the_place_of_a_solid_or_obstacle_is_removed_and_counted():
    solid = {"position": [1, 1, 0.6], "size": [0.4, 0.4, 0.4], "anchor": "base"}
    initial = build(scene(fluid=WATER, solid=[solid]))
    assert initial.counts["liquid"] == 500 - 8
    assert any("removed 8 liquid particles closer than 0.9 dx" in note for note in initial.notes)
    blocked = build(scene(fluid=WATER, obstacle=[{"position": [1, 1, 0.2], "size": [0.4, 0.4, 0.4]}]))
    assert blocked.counts["liquid"] == 500 - 8
    assert blocked.counts["wall"] == build(scene()).counts["wall"] + 8


def test_liquid_regions_that_overlap_give_one_particle_per_place():
    twice = {"fill": [*WATER["fill"], {"lower": [0, 0, 0.8], "upper": [2, 2, 1.2]}]}
    initial = build(scene(fluid=twice))
    assert initial.counts["liquid"] == 600
    assert any("removed 100 liquid particles that an earlier region has" in note for note in initial.notes)


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"solid": [{"position": [1, 1, 2], "size": [0.4] * 3}] * 2}, "stands in solid"),
        (
            {
                "solid": [{"position": [1, 1, 1], "size": [0.4] * 3}],
                "obstacle": [{"position": [1, 1, 1], "size": [0.4] * 3}],
            },
            "stands in a wall or obstacle with 8",
        ),
        ({"solid": [{"position": [-3, 1, 1], "size": [0.4] * 3}]}, "through the wall x-"),
        ({"fluid": {"fill": [{"lower": [0, 0, 0], "upper": [4, 2, 1]}]}}, "through the wall x\\+"),
        ({"solid": [{"shape": "sphere", "position": [1, 1, 1], "radius": 0.05}]}, "no lattice point"),
        ({"solid": [{"shape": "mesh", "file": "nowhere.ply", "position": [1, 1, 1]}]}, "does not exist"),
        (
            {
                "inflow": [
                    {"position": [9, 1, 1], "direction": [1, 0, 0], "radius": 0.2, "speed": 1, "layers": 2}
                ]
            },
            "through the wall x\\+",
        ),
    ],
)
def test_impossible_geometry_is_refused(sections, words):
    with pytest.raises(GeometryError, match=words):
        build(scene(**sections))


def test_box_off_the_lattice_is_moved_and_said():
    initial = build(scene(solid=[{"position": [1.05, 1, 1], "size": [0.4, 0.4, 0.5]}]))
    assert initial.counts["solid"] in (8, 12)
    assert any("moved by" in note for note in initial.notes) and any(
        "rounded" in note for note in initial.notes
    )


def test_sphere_of_8_95_spacings_has_the_specified_count():
    domain = {"upper": [6, 6, 6], "spacing": 0.2}
    ball = {"shape": "sphere", "position": [3.1, 3.1, 3.1], "radius": 8.95 * 0.2}
    assert build(scene(domain=domain, solid=[ball])).counts["solid"] == 2969


def test_sphere_holds_the_cell_centres_within_its_radius():
    domain = {"upper": [8, 8, 8], "spacing": 0.2}
    ball = {"shape": "sphere", "position": [4.03, 4.11, 2.0], "radius": 2.7, "anchor": "base"}
    centres = 0.1 + 0.2 * np.stack(np.meshgrid(*[np.arange(40)] * 3))
    within = ((centres.reshape(3, -1).T - [4.03, 4.11, 4.7]) ** 2).sum(axis=1) <= 2.7**2
    assert build(scene(domain=domain, solid=[ball])).counts["solid"] == within.sum()


def test_cylinder_lies_along_its_axis():
    domain = {"upper": [8, 8, 8], "spacing": 0.2}
    rod = {"shape": "cylinder", "position": [4, 4, 4], "radius": 2, "height": 6, "axis": "x"}
    initial = build(scene(domain=domain, solid=[rod]))
    assert initial.counts["solid"] * 0.008 == pytest.approx(np.pi * 4 * 6, rel=0.02)
    x = initial["position"][:, initial["phase"] == 1]
    assert np.ptp(x[0]) == pytest.approx(5.8) and np.ptp(x[1]) < 4


def test_sites_point_to_their_particles_and_back():
    initial = build(load_scene("four_densities_small"))
    live = initial["site_particle"] >= 0
    particle = initial["site_particle"][live]
    assert (initial["site"][particle] == np.flatnonzero(live)).all()
    assert ((initial["site"] >= 0) == (initial["phase"] == 1)).all()
    x = initial["position"][:, particle]
    assert np.abs(x - (initial["site_cell"][:, live] + 0.5) * 0.2).max() < 1e-9
    for body in range(4):
        mine = initial["site_body"][live] == body
        shift = x[:, mine] - initial["site_rest"][:, live][:, mine]
        assert np.abs(shift - shift[:, :1]).max() < 1e-9  # rest positions are the body's, moved
        assert np.abs(initial["site_rest"][:, live][:, mine]).max() <= 0.6


def test_refreezing_adds_vacant_sites_around_each_body():
    initial = build(load_scene("ice_cube_small", ["heat.refreeze=true", "heat.freeze_layers=2"]))
    assert initial["site_body"].size == 9**3
    assert (initial["site_particle"] >= 0).sum() == 5**3
    assert len(np.unique(initial["site_cell"], axis=1).T) == 9**3
    assert build(load_scene("ice_cube_small"))["site_body"].size == 5**3


def test_material_table_in_water_and_own_mode():
    water = build(load_scene("four_densities_small", ["heat.refreeze=true"]))
    assert water.materials == ["liquid", "red", "green", "blue", "yellow"]
    assert water["material_melts_to"].tolist() == [0, 0, 0, 0, 0]
    assert water["material_freezes_to"].tolist() == [1, -1, -1, -1, -1]
    assert water["material_conductivity"] == pytest.approx([0.008, 0.04, 0.04, 0.04, 0.04])
    own = build(load_scene("four_densities_small", ["heat.refreeze=true"], "physical"))
    assert own.materials[:3] == ["liquid", "red", "red melt"]
    assert own["material_melts_to"].tolist() == [0, 2, 2, 4, 4, 6, 6, 8, 8]
    assert own["material_freezes_to"].tolist() == [-1, -1, 1, -1, 3, -1, 5, -1, 7]
    assert own["material_density"][:3].tolist() == [1000.0, 10000.0, 10000.0]
    ice = build(load_scene("ice_cube_small", preset="physical"))
    assert ice["material_density"].tolist() == [1000.0, 917.0, 1000.0]
    assert np.isinf(ice["material_melting_point"]).tolist() == [True, False, True]


def test_solids_that_share_a_material_must_agree():
    same = ["solid.*.material=ice"]
    with pytest.raises(SceneError, match="share the material"):
        build(load_scene("four_densities_small", same))
    initial = build(load_scene("four_densities_small", [*same, "solid.*.density=917"]))
    assert initial.materials == ["liquid", "ice"]


def test_scene_without_heat_has_no_temperature():
    assert "temperature" not in build(load_scene("tank_small"))
    assert build(load_scene("ice_cube_small"))["temperature"].min() == -10.0


def test_nozzle_disc_is_square_to_its_direction():
    points = disc(5 * 0.2, [1, 2, -2], 0.2)
    assert points.shape == (3, 81)
    assert np.abs(np.array([1, 2, -2]) @ points).max() < 1e-12
    assert np.linalg.norm(points, axis=0).max() == pytest.approx(1.0)
    gaps = cKDTree(points.T).query(points.T, 2)[0][:, 1]
    assert gaps == pytest.approx(np.full(81, 0.2))


def test_heaters_and_wall_temperature():
    overrides = ["heat.wall_temperature=5 degC"]
    base = load_scene("ice_cube_small", overrides).model_dump(exclude_none=True)
    base["heat"]["heater"] = [
        {"position": [1, 1, 0.2], "size": [1, 2, 0.4], "rate": "2 K/s"},
        {"shape": "sphere", "position": [1, 1, 1], "radius": 0.3, "temperature": 90},
    ]
    initial = build(scene_from_dict(base))
    assert initial["heater_size"].T.tolist() == [[0.5, 1.0, 0.2], [0.3, 0.3, 0.3]]
    assert initial["heater_mode"].tolist() == [0, 1] and initial["heater_value"].tolist() == [2.0, 90.0]
    assert set(initial["temperature"][initial["phase"] == 2]) == {5.0}


def test_empty_scene_is_legal():
    initial = build(scene(domain={"upper": [1, 1, 1], "walls": {"sides": "none"}}))
    assert initial["position"].shape == (3, 0) and initial["site_rest"].shape == (3, 0)
