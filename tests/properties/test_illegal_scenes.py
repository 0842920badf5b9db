"""Illegal scenes are refused in words that name the key; what is accepted can be planned, written, read back and stepped."""

import copy
import math

import pytest
from base_scenes import SCENES
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scene_keys import in_words, keys_of, put

from melt.errors import MeltError, SceneError
from melt.preflight import plan
from melt.scene import scene_from_dict, scene_from_toml
from melt.scene.flood import FloodScene
from melt.scene.model import Scene
from melt.simulation import Simulation

LIQUID, FLOOD = sorted(keys_of(Scene), key=str), sorted(keys_of(FloodScene), key=str)
SYSTEMS = st.sampled_from(sorted(SCENES))
MOST = settings().max_examples
SMALL, FEW = 700, 20  # particles and sub-steps that a test takes time for
WORDS = ["", "x", "nan", "1 furlong", "1 m", "3 kg/m^", "1 (m", "1e999 s", "never", "auto", "\x00", "é" * 500]
TEXTS = st.sampled_from(WORDS) | st.text(max_size=5)
NUMBERS = st.floats() | st.integers(-5, 5) | st.integers() | st.sampled_from([10**400, -(10**400), 2**31, 2**63, 1e300, 1e-300, -273.16])
SIMPLE = NUMBERS | TEXTS | st.booleans() | st.none()
ANYTHING = st.recursive(SIMPLE, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(
    st.sampled_from(["x", "table", "file", "rate", "temperature"]), inner, max_size=2), max_leaves=6)  # fmt: skip


TRIED = set()  # scenes, as TOML: many values change nothing, or come to the same


def keys(system):
    return FLOOD if system == "flood" else LIQUID


def named(path, text):
    """Return whether a message names a key (or the value that it stands in)."""
    return any(".".join(map(str, path[:k])) in text for k in (len(path), len(path) - 1) if k) or " more" in text


def refused(data, *said):
    """Hold that a scene is refused in words; return them."""
    with pytest.raises(MeltError) as stop:
        scene_from_dict(data)
    in_words(stop.value, *said)
    return str(stop.value)


def refused_or_runs(data):
    """Hold that a scene is refused in words at some point, or comes as far as its first steps."""
    try:
        scene = scene_from_dict(data)
        assert scene_from_toml(scene.to_toml()) == scene
        if scene.to_toml() in TRIED:
            return
        TRIED.add(scene.to_toml())
        prepared = plan(scene).prepared
        patient = (prepared.settings.n_sub or 0) > FEW or getattr(prepared.settings, "settle", 0) > 0
        if prepared.sizes["particle"] <= SMALL and not patient:
            sim = Simulation(scene, "reference")
            sim.step()
            sim.frame(), sim.series()
    except MeltError as stop:
        in_words(stop)


@given(SYSTEMS, st.data())
def test_no_number_is_refused_at_every_key(system, data):
    path = data.draw(st.sampled_from(keys(system)))
    text = refused(put(SCENES[system], path, data.draw(st.sampled_from([math.nan, -math.inf]))))
    assert named(path, text), (path, text)


@given(SYSTEMS, st.data())
def test_an_unknown_key_is_named_in_every_section(system, data):
    path = data.draw(st.sampled_from(keys(system)))
    path = (*path[:-1], data.draw(st.text("abcdefgz_", min_size=1, max_size=6)) + "_zz")
    text = refused(put(SCENES[system], path, 1))
    assert named(path, text), (path, text)


@given(SYSTEMS, st.data())
def test_two_faults_are_two_sentences(system, data):
    paths = data.draw(st.lists(st.sampled_from([p for p in keys(system) if len(p) == 2]), min_size=2, max_size=2, unique=True))
    scene = put(put(SCENES[system], paths[0], math.nan), paths[1], math.nan)
    text = refused(scene)
    assert all(named(path, text) for path in paths), (paths, text)
    assert text.count("; ") >= 1, text


@given(SYSTEMS, st.data())
def test_a_negative_or_zero_size_is_refused(system, data):
    flood = [("fluid", "spacing"), ("fluid", "reference_depth"), ("terrain", "cell"), ("gravity",)]
    liquid = [("domain", "spacing"), ("fluid", "density")]
    path = data.draw(st.sampled_from([("time", "dt"), ("time", "end")] + (flood if system == "flood" else liquid)))
    text = refused(put(SCENES[system], path, data.draw(st.floats(max_value=0.0))))
    assert named(path, text) and ("greater than 0" in text or "finite" in text), text


@settings(max_examples=60 if MOST == 100 else MOST)
@given(SYSTEMS, st.data(), ANYTHING)
@example("boiling", ("domain", "gravity"), [0.0, 0.0, 0.0])
@example("boiling", ("fluid", "fill", 0, "velocity"), [1e300, 1e300, 1e300])
@example("boiling", ("boiling", "boost_speed"), 1e300)
@example("melting", ("time", "n_sub"), 2**63)
@example("melting", ("time", "n_sub"), 100_000)
@example("melting", ("time", "dt"), 1e300)
@example("melting", ("domain", "gravity"), [1e300, 1e300, 1e300])
@example("melting", ("domain", "spacing"), 1e300)
@example("melting", ("domain", "walls", "sides"), [{}])
@example("melting", ("domain", "walls", "layers"), 10**400)
@example("melting", ("domain", "spacing"), "1 km^999")
@example("melting", ("fluid", "alpha"), 1e300)
@example("melting", ("fluid", "alpha"), 10**400)
@example("melting", ("heat", "freeze_layers"), 2**31)
@example("melting", ("solver", "crumb"), 2**31)
@example("melting", ("solver", "rotation_iterations"), 1e15)
@example("slime", ("time", "dt"), 1e-300)
@example("flood", ("edge", 0, "discharge"), {"x": 1})
@example("flood", ("fluid", "fill", 0, "depth"), 1e15)
@example("flood", ("fluid", "reference_depth"), 1e-300)
@example("flood", ("fluid", "settle"), 1e15)
@example("flood", ("rain", "rate", "file"), "\x00")
@example("flood", ("rain", "rate", "file"), "é" * 500)
@example("flood", ("rain", "rate", "table"), [1, 2, 3])
@example("flood", ("terrain", "cell"), 1e-9)
def test_any_value_at_any_key_is_refused_in_words_or_runs(system, key, value):
    path = key if isinstance(key, tuple) else key.draw(st.sampled_from(keys(system)))
    refused_or_runs(put(SCENES[system], path, value))


@settings(max_examples=min(30, MOST))
@given(SYSTEMS, SYSTEMS, st.data())
def test_sections_of_two_systems_are_refused_in_words_or_run(one, other, data):
    scene = copy.deepcopy(SCENES[one])
    section = data.draw(st.sampled_from(sorted(SCENES[other])))
    scene[section] = copy.deepcopy(SCENES[other][section])
    refused_or_runs(scene)


@settings(max_examples=min(30, MOST))
@given(SYSTEMS, st.data())
def test_a_scene_that_lacks_a_key_is_refused_in_words_or_runs(system, data):
    scene = copy.deepcopy(SCENES[system])
    at = scene[data.draw(st.sampled_from(sorted(scene)))]
    at.pop(data.draw(st.sampled_from(sorted(at) or [""])), None) if isinstance(at, dict) else at.clear()
    refused_or_runs(scene)


@given(ANYTHING)
def test_a_scene_that_is_no_scene_is_refused(value):
    with pytest.raises(SceneError) as stop:
        scene_from_dict({"time": value, "domain": value, "solver": value, "heat": value})
    in_words(stop.value)
