"""The scene model: refusals that name key, value and remedy; presets; overrides; round trips."""

import json
import tomllib

import pytest

from melt.errors import SceneError
from melt.scene import PRESETS, Scene, load_scene, scene_from_dict, scene_from_toml, shipped_scenes
from melt.scene.toml import dumps

MINIMAL = {"time": {"end": 1.0}, "domain": {"upper": [1, 1, 1]}}


def with_override(*overrides, name="ice_cube", preset=None):
    return load_scene(name, overrides, preset)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("heat.conductivty=3", ["heat.conductivty", "did you mean 'conductivity'"]),
        ("fluid.density=-1", ["fluid.density", "-1", "greater than 0"]),
        ("fluid.density=nan", ["fluid.density", "nan"]),
        ("solid.0.density=0", ["solid.0.density", "greater than 0"]),
        ("time.dt=0", ["time.dt", "greater than 0"]),
        ("time.dt=-0.1", ["time.dt", "greater than 0"]),
        ("time.n_sub=some", ["time.n_sub", "whole number", "auto"]),
        ("time.n_sub=0", ["time.n_sub"]),
        ("domain.spacing=0", ["domain.spacing", "greater than 0"]),
        ("solver.support=0", ["solver.support"]),
        ("solver.width=-1", ["solver.width", "at least 0"]),
        ("solver.width=6", ["solver.width", "at most 5"]),
        ("heat.conductivity=-3", ["heat.conductivity", "at least 0"]),
        ("solid.0.conductivity=-3", ["solid.0.conductivity", "at least 0"]),
        ("solid.0.melting_point=nan", ["solid.0.melting_point", "nan"]),
        ("fluid.temperature=5 kg", ["fluid.temperature", "is a mass, expected a temperature"]),
        ("heat.conductivity=5 W/(m K)", ["heat.conductivity", "expected a number"]),
        ("heat.law=phys", ["heat.law", "paper", "physical"]),
        ("solver.kernel=gauss", ["solver.kernel", "cubic", "wendland2"]),
        ("solver.connect=7", ["solver.connect", "6, 18 or 26"]),
        ("solver.guard=perhaps", ["solver.guard", "true or false"]),
        ("domain.upper=[1, 2]", ["domain.upper", "list of 3"]),
        ("domain.upper=[-1, 2, 2]", ["upper", "exceed lower"]),
        ('domain.walls.sides=["up"]', ["domain.walls.sides", "up"]),
        ("solver.melt_to=own", ["density_form"]),
        ("fluid.sound_speed=legal", ["time.n_sub"]),
        ("solid.0.size=none", ["solid.0", "a box needs"]),
        ("solid.0.radius=2", ["solid.0", "radius", "not for a box"]),
        ("solid.0.position=none", ["solid.0", "position"]),
        ("solid.1.density=3", ["solid.1.density", "1 items"]),
        ("fluid.freezes_to=stone", ["freezes_to", "stone", "ice"]),
        ("heat.ambient_transfer=2", ["ambient_temperature"]),
        ("gravity", ["KEY=VALUE"]),
        ("time.end=none", ["time.end", "missing"]),
    ],
)
def test_bad_value_is_refused_in_one_paragraph(override, words):
    with pytest.raises(SceneError) as caught:
        with_override(override)
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message, message


def test_unknown_scene_names_close_matches():
    with pytest.raises(SceneError, match="did you mean ice_cube"):
        load_scene("ice_cub")
    with pytest.raises(SceneError, match="does not exist"):
        load_scene("nowhere/scene.toml")


def test_text_that_is_no_toml_is_refused(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text("[time\nend = 1")
    with pytest.raises(SceneError, match="not valid TOML"):
        load_scene(path)


@pytest.mark.parametrize("name", sorted(shipped_scenes()))
@pytest.mark.parametrize("preset", [None, *PRESETS])
def test_scene_round_trips_through_toml(name, preset):
    scene = load_scene(name, preset=preset)
    assert scene_from_toml(scene.to_toml()) == scene


@pytest.mark.parametrize("name", sorted(shipped_scenes()))
def test_shipped_scene_names_itself_and_what_it_stands_for(name):
    about = load_scene(name).scene
    assert about.name == name
    assert about.figure and about.description


def test_override_beats_file_and_file_beats_preset():
    assert load_scene("ice_cube").solver.mirror == 1.0
    assert load_scene("ice_cube", preset="paper").solver.mirror == 0.0
    assert load_scene("ice_cube", ["solver.mirror=0.5"], "paper").solver.mirror == 0.5
    explicit = scene_from_dict({**MINIMAL, "solver": {"mirror": 0.25}}, preset="paper")
    assert explicit.solver.mirror == 0.25


def test_override_reaches_all_items_and_makes_sections():
    scene = load_scene(
        "four_densities",
        ["solid.*.density=500", "heat.ambient_transfer=1 m/s", "heat.ambient_temperature=20 degC"],
    )
    assert [s.density for s in scene.solid] == [500.0] * 4
    assert scene.heat.ambient_transfer == 1.0
    assert load_scene("tank_small").heat is None
    assert load_scene("tank_small", ["heat.latent=true"]).heat.latent is True
    assert load_scene("ice_cube", ["heat=none"]).heat is None


def test_preset_adds_no_heat_to_a_scene_without_it():
    assert load_scene("tank", preset="physical").heat is None


def test_paper_preset_is_literal():
    scene = load_scene("ice_cube", preset="paper")
    assert (scene.time.n_sub, scene.fluid.sound_speed) == (1, "legal")
    assert (scene.heat.sweep_dt, scene.heat.volume) == ("full", "current")
    assert (scene.solver.mirror, scene.solver.damping, scene.solver.neighbours) == (0.0, 0.0, "kdtree")


def test_physical_preset_keeps_mass_and_has_latent_heat():
    scene = load_scene("ice_cube", preset="physical")
    assert (scene.heat.law, scene.heat.latent, scene.solver.melt_to) == ("physical", True, "own")
    assert scene.solver.density_form == "volume"


@pytest.mark.parametrize("name, overrides", [("ice_cube_small", ["solver.pressure=dfsph"]), ("kettle_ice", ["solver.melt_to=none"])])
def test_physical_preset_keeps_mass_whatever_the_liquid(name, overrides):
    scene = load_scene(name, overrides, "physical")
    assert scene.solver.melt_to == "own" and scene.heat.latent and scene.heat.law == "physical"


def test_a_liquid_has_the_presets_of_the_system_that_moves_it():
    """A position based liquid that does not boil has no mirrored pressure, guard or sub-step of weakly compressible SPH to give up."""
    default, paper = (load_scene("tank_small", ["solver.pressure=pbf"], preset) for preset in (None, "paper"))
    assert default.system == paper.system == "boiling"
    assert (paper.solver.precision, paper.time.n_sub, paper.fluid.sound_speed) == ("single", default.time.n_sub, "auto")
    assert load_scene("tank_small", preset="paper").time.n_sub == 1


def test_unknown_preset_lists_the_known_ones():
    with pytest.raises(SceneError, match="did you mean paper.*physical"):
        load_scene("ice_cube", preset="papr")


def test_own_preset_of_a_scene_overlays_its_values():
    data = {**MINIMAL, "presets": {"draft": {"solver.kernel": "wendland2", "fluid.alpha": 0.3}}}
    scene = scene_from_dict(data, preset="draft")
    assert (scene.preset, scene.solver.kernel, scene.fluid.alpha) == ("draft", "wendland2", 0.3)
    assert scene_from_dict(data).solver.kernel == "cubic"


def test_conductivity_is_a_figure_number_by_the_papers_law_and_has_units_by_the_physical():
    paper = load_scene("ice_cube")
    assert (paper.heat.conductivity, paper.heat.conductivity_scale) == (10.0, 0.01)
    physical = load_scene("ice_cube", ["heat.law=physical", "heat.conductivity=560 mW/(m K)"])
    assert (physical.heat.conductivity, physical.heat.conductivity_scale) == (pytest.approx(0.56), 1.0)


def test_never_melting_body():
    assert load_scene("ice_cube", ["solid.0.melting_point=never"]).solid[0].melting_point == float("inf")


def test_names_of_solids_are_unique():
    with pytest.raises(SceneError, match="given twice"):
        load_scene("four_densities", ["solid.1.name=red"])


def test_schema_describes_every_section_with_units():
    schema = Scene.model_json_schema()
    assert {"time", "domain", "fluid", "solid", "heat", "inflow", "obstacle", "solver"} <= set(
        schema["properties"]
    )
    assert schema["$defs"]["Domain"]["properties"]["spacing"]["unit"] == "m"
    assert "Outer step" in schema["$defs"]["Time"]["properties"]["dt"]["description"]
    assert schema["additionalProperties"] is False
    json.dumps(schema)


def test_toml_text_reads_back():
    data = {
        "a": 1,
        "b": [1.5, float("inf")],
        "c": {"d e": 'x\n"y"\x7f', "f": [{"g": True}, {"g": False, "h": {"i": 1}}]},
    }
    assert tomllib.loads(dumps(data)) == data
