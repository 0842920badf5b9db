"""Bubbles show inside the liquid, vapour above it, and neither costs a run that has none."""

import numpy as np
import pytest
from run_samples import drop_and_cube

from melt.output import gas as gases
from melt.output import splat
from melt.output.mesh_files import surfaces
from melt.output.picture import Painter, render
from melt.output.run_file import RunWriter
from melt.output.run_reader import open_run

SIZE, D = (360, 240), 0.02
SCENE = f"[scene]\nname = 'tank'\n[domain]\nlower = [0, 0, 0]\nupper = [0.24, 0.24, 0.36]\nspacing = {D}\n"
MIDDLE = (0.12, 0.12, 0.10)


def tank(bubbles=(), vapour=(), solid=(), radius_field=True):
    """Return a frame: 12 x 12 x 10 liquid particles with the bubbles (x, y, z, r) carved out, vapour, solids."""
    cells = np.stack(np.meshgrid(np.arange(12), np.arange(12), np.arange(10), indexing="ij"), -1).reshape(-1, 3)
    x = (cells + 0.5) * D
    for *centre, r in bubbles:
        x = x[np.linalg.norm(x - centre, axis=1) > r]
    parts = [x, np.array([b[:3] for b in bubbles]), np.array(vapour), np.array(solid)]
    parts = [p.reshape(-1, 3) for p in parts]
    phase = np.repeat([0, 3, 4, 1], [len(p) for p in parts]).astype(np.int32)
    radius = np.zeros(len(phase), np.float32)
    radius[phase == 3] = [b[3] for b in bubbles]
    x = np.concatenate(parts).astype(np.float32)
    temperature = (90 + 40 * x[:, 0]).astype(np.float32)  # does not know of bubbles: one colour scale
    frame = {"position": x, "phase": phase, "temperature": temperature}
    return frame | ({"bubble_radius": radius} if radius_field else {})


def painters(path, *frames, **options):
    """Write frames as a run of their own behind the plain tank and return their pictures, float, under one camera."""
    with RunWriter(path, SCENE, {}, overwrite=True) as writer:
        for k, frame in enumerate((tank(vapour=[(0.12, 0.12, 0.34)]), *frames)):
            writer.append(0.1 * k, frame)
    painter = Painter(open_run(path), size=SIZE, **options)
    return painter, [painter.draw(k + 1).astype(float) for k in range(len(frames))]


def disc(painter, centre, radius):
    """Return distance of the pixels to the projected centre, in projected radii, and their height above it."""
    x, y = painter.camera.pixels(np.array([centre]))[0]
    size = radius / painter.camera.view(np.array([centre]))[0, 2] * painter.camera.focal
    rows, columns = np.indices((SIZE[1], SIZE[0])) + 0.5
    return np.hypot(columns - x, rows - y) / size, (y - rows) / size


@pytest.mark.parametrize("surface", [False, True])
@pytest.mark.parametrize("view", ["iso", "side"])
def test_a_bubble_deep_inside_is_seen_through_the_liquid(tmp_path, view, surface):
    """Bright rim above, dark below, clear in the middle; the picture far from it stays."""
    r = 0.025
    painter, (still, boiling) = painters(
        tmp_path / "a.vtkhdf", tank(), tank([(*MIDDLE, r)]), view=view, surface=surface
    )
    q, above = disc(painter, MIDDLE, r)
    change = np.abs(boiling - still).mean(axis=2)
    text = np.indices(change.shape)[0] > 0.9 * SIZE[1]  # time and counts
    assert change[q < 1].mean() > (12 if surface else 8)
    assert change[(q > 1.6) & ~text].mean() < 0.6
    ring = (q > 0.75) & (q < 0.95)
    light = boiling.mean(axis=2)
    assert light[ring & (above > 0.4)].mean() > light[ring & (above < -0.4)].mean() + 25


def test_bubbles_have_their_own_radius(tmp_path):
    spread = []
    for r in (0.012, 0.03):
        painter, (still, boiling) = painters(
            tmp_path / "a.vtkhdf", tank(), tank([(*MIDDLE, r)]), view="side", surface=True
        )
        change = np.abs(boiling - still).mean(axis=2)
        q, _ = disc(painter, MIDDLE, 1.0)
        seen = (change > 12) & (q < 0.06)
        spread.append(q[seen].max())
    assert spread == pytest.approx([0.012, 0.03], rel=0.2)


@pytest.mark.parametrize("surface", [False, True])
def test_a_solid_in_front_hides_bubbles_and_vapour(tmp_path, surface):
    plate = [(i * D / 2, -0.03, k * D / 2) for i in range(-2, 27) for k in range(38)]
    place = (0.12, 0.12, 0.32)
    _, (plain, gassy) = painters(
        tmp_path / "a.vtkhdf", tank(solid=plate), tank([(*MIDDLE, 0.025)], [place], plate), view="side", surface=surface
    )
    lines = slice(0, int(0.9 * SIZE[1]))
    assert np.abs(gassy - plain)[lines].max() <= 6


def test_vapour_is_a_faint_white_puff_above(tmp_path):
    place = (0.12, 0.12, 0.31)
    painter, (still, steaming) = painters(tmp_path / "a.vtkhdf", tank(), tank(vapour=[place]), view="side")
    q, _ = disc(painter, place, D)
    lines = np.indices(q.shape)[0] < 0.9 * SIZE[1]
    brighter = (steaming - still).min(axis=2)
    assert 4 < brighter[q < 0.7].mean() < 60
    assert np.abs(steaming - still)[(q > 2.6) & lines].max() == 0


def test_nearer_bubbles_cover_farther_ones_in_any_order(tmp_path):
    near, far = (0.12, 0.06, 0.10, 0.025), (0.12, 0.18, 0.10, 0.015)
    _, (one, other) = painters(tmp_path / "a.vtkhdf", tank([near, far]), tank([far, near]), view="side", surface=True)
    lines = slice(0, int(0.9 * SIZE[1]))
    assert np.array_equal(one[lines], other[lines])


def test_a_run_without_the_field_never_comes_here(tmp_path, monkeypatch):
    """Runs without bubbles keep their pictures: nothing of this module is called for them."""
    run = open_run(drop_and_cube(tmp_path / "a.vtkhdf"))
    drawn = [Painter(run, surface=s, size=SIZE).draw(1) for s in (False, True)]

    def never(*_, **__):
        raise AssertionError("drew gas")

    for name in ("of", "filled", "draw"):
        monkeypatch.setattr(gases, name, never)
    for name in ("bubbles", "puffs"):
        monkeypatch.setattr(splat, name, never)
    for surface, before in zip((False, True), drawn):
        assert np.array_equal(Painter(run, surface=surface, size=SIZE).draw(1), before)
    plain = tank([(*MIDDLE, 0.025)], radius_field=False)
    with RunWriter(tmp_path / "b.vtkhdf", SCENE, {}) as writer:
        writer.append(0, plain)
    assert Painter(open_run(tmp_path / "b.vtkhdf"), size=SIZE).draw(0).std() > 5


def test_the_surface_passes_over_bubbles():
    """With the bubble filled up the surface has one sheet and encloses the whole block; else a cavity is left."""
    frame = tank([(*MIDDLE, 0.045)])
    phase, values = frame["phase"], np.arange(len(frame["phase"]), dtype=float)
    gas = gases.of(frame, phase, np.ones(len(phase), bool), D)
    whole, filled = gases.filled(frame, phase, values, gas.bubbles, D)
    number = len(filled) - len(values)
    assert 0.5 < number * D**3 / (4 / 3 * np.pi * 0.045**3) < 1.2
    assert set(filled[len(values) :]) <= set(values[phase == 0])
    full, holed, carved = (
        surfaces(f, v, D)["liquid"].volume() for f, v in ((tank(), np.zeros(1440)), (whole, filled), (frame, values))
    )
    assert holed == pytest.approx(full, rel=0.01) and carved < full - 0.5 * 4 / 3 * np.pi * 0.045**3


def test_a_bubble_out_of_the_liquid_brings_none_along():
    frame = tank([(0.12, 0.12, 0.34, 0.02)])
    phase = frame["phase"]
    gas = gases.of(frame, phase, np.ones(len(phase), bool), D)
    whole, values = gases.filled(frame, phase, np.zeros(len(phase)), gas.bubbles, D)
    assert len(whole["position"]) == len(values) == len(phase)


def test_bad_numbers_and_empty_frames(tmp_path):
    odd = tank([(*MIDDLE, 0.02), (0.1, 0.1, 0.1, np.nan), (0.2, 0.1, 0.1, 0.0), (0.1, 0.2, np.nan, 0.02)])
    dry = tank([(*MIDDLE, 0.02)], [(0.12, 0.12, 0.3)])
    dry = {name: values[dry["phase"] != 0] for name, values in dry.items()}
    none = {name: values[:0] for name, values in dry.items()}
    with RunWriter(tmp_path / "a.vtkhdf", SCENE, {}) as writer:
        for k, frame in enumerate((odd, dry, none)):
            writer.append(k, frame)
    for surface in (False, True):
        for k in range(3):
            render(tmp_path / "a.vtkhdf", tmp_path / "a.png", frame=k, surface=surface, size=(160, 90))
