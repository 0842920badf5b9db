"""The accuracy dial: every shipped scene has knobs that load and a named error; fronts, presets and choices are what they say."""

import math

import numpy as np
import pytest
from slime_scenes import slime, square

from melt.dial import choose, measure, sweep, systems
from melt.dial.exact import EXACT, plate_speed
from melt.dial.front import on_front, presets_of
from melt.dial.vocabulary import Knob, Measure, errors_of, headline
from melt.errors import MeltError, SceneError
from melt.scene import fronts, load_scene, shipped_scenes
from melt.scene.fronts import MEASURED, Front, FrontPoint, as_text, front_of_text, front_path, stored_front
from melt.scene.model import About
from melt.simulation import Simulation

STORED = {name: front for name, path in shipped_scenes().items() if (front := stored_front(path)) is not None}


def point(cost, error, spread=0.1, name="", **more):
    return FrontPoint(name or f"p{cost:g}", more.pop("overrides", ()), 10.0 * cost, float(cost), 1000, error, spread, **more)


@pytest.mark.parametrize("name", shipped_scenes())
def test_dial_of_every_shipped_scene_loads_and_names_its_error(name):
    scene = load_scene(name)
    system, what = systems.system_of(scene), systems.measure_of(scene)
    knobs = systems.candidates(scene, lambda overrides: load_scene(name, overrides))
    for knob in (*system.combined(scene), *system.knobs(scene)):  # none of a shipped scene is left out for being refused
        load_scene(name, [*system.shared(scene), *knob.overrides])
    labels = [knob.label for knob in knobs]
    assert labels[0] == "default" and len(labels) == len(set(labels)) >= 8
    assert sum(label.startswith("combined") for label in labels) >= 2
    assert what.words and what.exact == (scene.scene.exact is not None)
    again = load_scene(name, [*system.shared(scene), *system.reseeded(scene, 1)])
    assert (again != load_scene(name, system.shared(scene))) == bool(system.reseeded(scene, 1))
    if not what.exact:
        assert load_scene(name, [*system.shared(scene), *system.reference(scene)]).solver.precision == "double"


def test_scenes_can_name_each_exact_solution_and_no_other():
    names = About.model_fields["exact"].annotation.__args__[0].__args__
    assert set(names) == set(EXACT) == {load_scene(name).scene.exact for name in shipped_scenes()} - {None}


@pytest.mark.parametrize("exact", EXACT)
def test_a_solution_of_another_scene_is_refused_with_what_it_is_of(exact):
    for name in ("tank_small", "kettle_small", "rough_terrain", "stoker", "couette"):
        scene = load_scene(name, [f"scene.exact={exact}"])
        if not EXACT[exact].fits(scene):
            with pytest.raises(SceneError, match=f"scene.exact = '{exact}' is of "):
                systems.measure_of(scene)
    assert sum(EXACT[exact].fits(load_scene(name)) for name in shipped_scenes() if load_scene(name).scene.exact == exact) >= 1


def test_knobs_that_a_scene_of_ones_own_refuses_are_left_out():
    def load(overrides):
        if any("heat.solver" in text for text in overrides):
            raise SceneError("heat.solver is not for this scene")
        return load_scene("ice_cube_small", overrides)

    labels = [knob.label for knob in systems.candidates(load([]), load)]
    assert "heat sub-steps 4" in labels and not any("heat solver" in label for label in labels)


def test_error_is_relative_to_the_change_of_the_reference_but_not_below_its_floor():
    t, truth = np.arange(5.0), np.arange(0.0, 10.0, 2.0)
    measure = Measure("", {"x": 1.0, "y": 1.0})
    found = errors_of(t[::2], {"x": truth[::2] + 0.8, "y": np.array([0.1, 0.1, np.nan])}, (t, {"x": truth, "y": 0 * truth}), measure)
    assert found == pytest.approx({"x": 0.1, "y": 0.1})
    for errors in ({"a": 0.1, "b": math.nan}, {"b": math.nan, "a": 0.1}, {}):
        assert math.isnan(headline(errors))


def test_front_holds_what_no_other_beats_and_presets_follow_their_rules():
    points = [point(10, 4.0), point(12, 4.5), point(3, 13.0), point(4, 7.5), point(20, 1.0, 0.3), point(15, 1.2), point(90, 0.1),
              FrontPoint("bad", (), math.nan, math.nan, 0, math.nan, math.nan, failure="unstable: x")]  # fmt: skip
    assert on_front(points) == [2, 3, 0, 5, 4, 6]
    # accurate: 0.1 % costs too much, 1.2 % is within the spread of 1.0 %; draft: 13 % is more than three times the default's
    assert presets_of(points) == {"draft": 3, "balanced": 0, "accurate": 5}
    assert presets_of(points[-1:]) == {}


def test_front_comes_back_from_its_file():
    front = Front({"scene": "a", "error": "b, c: d"}, sweep.chosen([
        point(10, 4.0, math.nan), point(2, 6.0, overrides=("a.b=[1, 2]", 'c="x"')),
        FrontPoint("bad, one", ("a=1",), math.nan, math.nan, 0, math.nan, math.nan, failure="unstable: at step 3, x"),
    ]))  # fmt: skip
    again = front_of_text(as_text(front))
    assert again.facts == front.facts and str(again.points) == str(front.points)
    assert again.preset("draft").overrides == ("a.b=[1, 2]", 'c="x"')


def test_every_shipped_scene_has_a_front():
    assert sorted(STORED) == sorted(shipped_scenes())


@pytest.mark.parametrize("name", STORED)
def test_presets_of_stored_fronts_load_and_lie_on_them(name):
    front = STORED[name]
    assert front.facts["error"] and front.points[0].point == "default"
    again = sweep.chosen([p._replace(on_front=False, presets=()) for p in front.points])
    assert [p.presets for p in again] == [p.presets for p in front.points]
    for preset in MEASURED:
        assert front.preset(preset).on_front
        assert load_scene(name, preset=preset) == load_scene(name, front.preset(preset).overrides)


def test_choice_by_error_is_the_cheapest_within_and_by_time_the_best_that_fits():
    front = Front({}, [point(10, 4.0, name="default"), point(2, 6.0), point(30, 1.0, 0.5)])
    assert choose.by_error(front, 7).point == "p2" and choose.by_error(front, 1.5).point == "p30"
    with pytest.raises(MeltError, match="nearest is 'p30' with 1 %"):
        choose.by_error(front, 1.4)
    scene = load_scene("tank_small")
    forecast = choose.by_time(front, scene, 1e9)
    assert forecast.point == "p30"
    with pytest.raises(MeltError, match="nearest, 'p2', takes"):
        choose.by_time(front, scene, 1e-6)
    assert choose.share("2%") == choose.share("0.02") == 2
    for text in ("much", "-1%", "nan", "0"):
        with pytest.raises(MeltError, match="write a share"):
            choose.share(text)


def test_sweep_of_a_scene_of_ones_own_stores_its_front_and_keeps_its_reference(tmp_path):
    path = tmp_path / "my.toml"
    path.write_text(shipped_scenes()["tank_small"].read_text())
    with pytest.raises(SceneError, match="none is stored for .*my.toml: run melt tradeoff"):
        load_scene(path, preset="draft")
    knobs = [Knob("default", ""), Knob("precision", "single", ("solver.precision=single",))]
    knobs += [Knob("bad", "", ("domain.gravity=[0, 0, -1e30]",))]
    with pytest.raises(MeltError, match="cannot be written"):
        sweep.run(path, out=tmp_path / "nowhere" / "s.h5", knobs=knobs)
    with pytest.raises(MeltError, match="a study is an HDF5 file, not my.toml"):
        sweep.run(path, out=path, knobs=knobs)
    said = []
    options = dict(steps=3, seeds=2, knobs=knobs, cache=tmp_path / "cache", say=said.append)
    first = sweep.run(path, keep=True, out=tmp_path / "s.h5", **options)
    second = sweep.run(path, **options)
    assert not [p for p in tmp_path.rglob("*") if p.suffix in (".part", ".tmp")]
    assert not any("kept from" in line for line in said[: len(said) // 2]) and any("kept from" in line for line in said)
    assert front_path(path) == tmp_path / "my.front.csv" and (tmp_path / "s.png").exists()
    stored = stored_front(path)
    assert [p.point for p in stored.points] == ["default", "precision single", "bad"]
    assert stored.points[2].failure.startswith("unstable") and stored.points[0].spread > 0
    assert [p.error for p in first.front.points[:2]] == [p.error for p in second.front.points[:2]]
    assert stored.points[1].bytes < stored.points[0].bytes
    assert sweep.fresh(path) and load_scene(path, preset="draft") == load_scene(path, stored.preset("draft").overrides)
    path.write_text(path.read_text().replace('dt = "5 ms"', 'dt = "4 ms"'))
    assert not sweep.fresh(path)


def test_a_reference_run_that_fails_is_told_from_the_scene(tmp_path):
    bad = ["domain.gravity=[0, 0, -1e30]"]
    with pytest.raises(MeltError, match="all others are compared with .* does not work"):
        sweep._reference(lambda overrides: load_scene("tank_small", overrides), bad, 0.01, tmp_path)


@pytest.mark.parametrize("spoilt", [b"", b"PK", b"PK\x03\x04 half of it", b"words"])
def test_a_kept_reference_that_is_not_whole_is_made_again(spoilt, tmp_path):
    def made():
        return measure.reference_run(lambda overrides: load_scene("couette", overrides), [], 0.001, tmp_path)

    first, kept = made()
    assert not kept and made()[1]
    (path,) = tmp_path.glob("*.npz")
    path.write_bytes(spoilt)
    again, kept = made()
    assert not kept and np.array_equal(again.times, first.times)


def test_an_installed_melt_is_not_written_to(tmp_path, monkeypatch):
    scene = tmp_path / "melt" / "data" / "scenes" / "tank_small.toml"
    scene.parent.mkdir(parents=True)
    scene.write_text(shipped_scenes()["tank_small"].read_text())
    monkeypatch.setattr(fronts, "PACKAGE", tmp_path / "melt")
    for store in (lambda: sweep.run(scene, keep=True), lambda: sweep.run_all({"a": scene}, {"keep": True, "say": print})):
        with pytest.raises(MeltError, match="tank_small is a scene of the installed melt.* copy .* to a folder of yours"):
            store()
    assert front_path(scene) == tmp_path / "melt" / "data" / "fronts" / "tank_small.csv" and not front_path(scene).parent.exists()


def test_own_preset_of_a_scene_goes_before_the_measured_one(tmp_path):
    path = tmp_path / "my.toml"
    path.write_text(shipped_scenes()["tank_small"].read_text() + '\n[presets.draft]\n"fluid.alpha" = 0.3\n')
    assert load_scene(path, preset="draft").fluid.alpha == 0.3


def test_repetitions_differ_from_the_scene_by_a_thousandth_of_a_spacing():
    from melt.geometry.build import build

    scene = load_scene("couette")
    still, shaken, again = build(scene), build(scene), build(scene)
    measure.shake(shaken, scene, 1)
    measure.shake(again, scene, 1)
    moved = np.abs(shaken["position"] - still["position"])
    assert 0 < moved.max() <= 1.001e-3 * scene.spacing and moved[1].max() == 0
    assert np.array_equal(shaken["position"], again["position"])


@pytest.mark.parametrize("name, overrides", [
    ("honey_coil_small", ("solver.apic=none",)), ("hydrostatic", ("solver.ghosts=none", "solver.pressure=dfsph")),
])
def test_repetitions_have_what_the_candidate_has_and_are_all_shaken(name, overrides, monkeypatch):
    """A seed of what a knob has taken out would bring it back."""
    runs = []

    def sample(scene, window, shaken, patience):
        runs.append((scene, shaken))
        return measure.Sample(np.zeros(1), {"x": np.zeros(1)}, 1.0, 1.0, 1, 1, 0.5)

    def load(overrides):
        return load_scene(name, overrides)

    monkeypatch.setattr(measure, "sample", sample)
    what = Measure("", {}, exact=True)
    *_, spent = sweep.measured(load, systems.system_of(load([])), Knob("off", "", overrides), [], 1.0, None, what, 3, np.inf)
    assert [shaken for _, shaken in runs] == [0, 1, 2] and spent == 1.5
    assert {(scene.solver.apic is None, scene.solver.ghosts is None) for scene, _ in runs} == {
        ("solver.apic=none" in overrides or name == "hydrostatic", "solver.ghosts=none" in overrides)
    }

    def slow(*_):
        raise measure.TooSlow("given up")

    monkeypatch.setattr(measure, "sample", slow)
    assert sweep.measured(load, systems.system_of(load([])), Knob("off", "", overrides), [], 1.0, None, what, 3, 20.0)[3] == 20.0


def test_exact_solutions_hold_wherever_a_scene_has_them():
    """A patch that turns off the origin, and one that travels too; a plate at rest whose force is measured."""
    for centre in (0.3, 0.0):
        patch = {"fill": [square((0, -3), (6, 6))], "flow": {"kind": "rotation", "rate": 2.0, "centre": [centre, 0, 0]}}
        errors = EXACT["rotation"].errors(Simulation(slime(fluid=patch, solver={"apic": None}), "cpu"))
        assert max(errors.values()) < 1e-12
    assert plate_speed(load_scene("couette", ["obstacle.0.force=true"])) == 0.1


def test_knobs_of_shifted_particles_load():
    shifted = ["solver.pressure=isph", "solver.dfsph.shift=0.1"]
    assert len(systems.candidates(load_scene("taylor_green", shifted), lambda more: load_scene("taylor_green", [*shifted, *more]))) > 8


def test_sweep_of_all_scenes_skips_fresh_fronts_and_goes_on_after_a_failure(monkeypatch):
    done, said = [], []

    def run(name, **options):
        done.append(name)
        if name == "b":
            raise MeltError("it cannot be built")

    monkeypatch.setattr(sweep, "run", run)
    monkeypatch.setattr(sweep, "fresh", lambda path: path == "a.toml")
    assert sweep.run_all({name: f"{name}.toml" for name in "abc"}, {"keep": True, "say": said.append}) == ["b"]
    assert done == ["b", "c"] and said == ["a: its front is fresh", "b: it cannot be built"]


def test_dear_scene_gets_fewer_candidates_rather_than_a_run_too_short():
    knobs = [Knob("default", "")] + [Knob("compression", str(k), (f"fluid.compression={0.001 * k}",)) for k in range(1, 9)]
    lots = sweep.lay_out(lambda overrides: load_scene("tank_small", overrides), knobs, [], ["solver.precision=double"], 2, 1e6)
    few = sweep.lay_out(lambda overrides: load_scene("tank_small", overrides), knobs, [], ["solver.precision=double"], 2, 0.1)
    scene = load_scene("tank_small")
    assert len(lots[0]) == 9 and lots[1] == pytest.approx(scene.time.end)
    assert few[0] == knobs[: sweep.LEAST] and few[1] == pytest.approx(sweep.FEWEST * scene.time.dt)
    asked = sweep.lay_out(lambda overrides: load_scene("tank_small", overrides), knobs, [], [], 2, 0.1, steps=7)
    assert len(asked[0]) == 9 and asked[1] == pytest.approx(7 * scene.time.dt)
