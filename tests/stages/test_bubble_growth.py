"""Radius of bubbles: laws, limits, and that a bubble which has not grown is known by its bits (boiling 2.5, section 6)."""

import numpy as np
import pytest
from bubble_cases import BUBBLE, LIQUID, VAPOUR, R, pool, rounding, run
from liquid_cases import both, everywhere
from pbf_cases import D

from melt.physics.bubbles import radius_of


def volume(radius):
    return 4 / 3 * np.pi * np.asarray(radius, float) ** 3


def bubbles(heights, radii, born, ages, precision="double"):
    n = len(heights)
    x = np.column_stack([np.arange(n) * D, np.zeros(n), heights])
    return pool(x, BUBBLE, precision, bubble_volume=volume(radii), birth_height=born, age=ages, bubble_radius=np.full(n, 9.0))


@everywhere
@both
def test_growth_by_hand(backend, precision):
    """r0 (1 + xi tau/3): half risen at full age, risen at half age, beyond both limits, sunk below the birth height."""
    a = bubbles([0.17, 0.29, 1.0, 0.04], [0.01] * 4, [0.05] * 4, [0.6, 0.24, 9.0, 9.0], precision)
    out = run("bubble_growth", backend, a, dt=0.01)
    want = 0.01 * np.array([1 + 0.5 / 3, 1 + 0.5 / 3, 4 / 3, 1])
    rel, _ = rounding(precision)
    assert out["bubble_radius"] == pytest.approx(want, rel=rel)
    assert out["age"] == pytest.approx([0.61, 0.25, 9.01, 9.01], rel=rel)
    assert out["rest_volume"] == pytest.approx(volume(want), rel=4 * rel)


@everywhere
def test_height_is_above_the_floor(backend):
    a = bubbles([1.17], [0.01], [0.05], [0.6])
    assert run("bubble_growth", backend, a, dt=0.0, floor=1.0)["bubble_radius"] == pytest.approx([0.01 * (1 + 0.5 / 3)], rel=1e-13)


@pytest.mark.parametrize("backend", ["cpu", "cuda-emulated"])
@pytest.mark.parametrize("precision", ["single", "mixed", "double"])
def test_without_growth_the_radius_is_that_of_the_volume_to_the_bit(backend, precision):
    rng = np.random.default_rng(2)
    r = 10 ** rng.uniform(-4, 0, 200)
    heights = np.where(np.arange(200) < 100, 0.05, 0.2)
    a = bubbles(heights, r, np.full(200, 0.05), np.where(np.arange(200) < 100, 3.0, 0.0), precision)
    run("bubble_growth", backend, a, dt=0.0)
    real = a["mass"].dtype.type
    assert [real(radius_of(V)) for V in a["bubble_volume"]] == a["bubble_radius"].tolist()
    assert a["bubble_radius"] == pytest.approx(r, rel=3e-7 if real is np.float32 else 2e-15)


@everywhere
def test_growth_stops_at_the_largest_radius_and_merging_does_not(backend):
    """Section 6: r_max = 2 R. The volume in the solve is capped at 4.2 d^3."""
    most = 2 * R
    a = bubbles([0.29] * 3, [0.9 * most, 1.5 * most, 0.5 * D], [0.05] * 3, [9.0] * 3)
    out = run("bubble_growth", backend, a, dt=0.01)
    assert out["bubble_radius"] == pytest.approx([most, 1.5 * most, 2 / 3 * D], rel=1e-13)
    assert out["rest_volume"] == pytest.approx([4.2 * D**3, 4.2 * D**3, volume(2 / 3 * D)], rel=1e-13)


@everywhere
@both
def test_law_of_the_paper(backend, precision):
    """r = 0.75 max(h, d) + 0.25 (y - h) t, between birth radius and largest radius."""
    a = bubbles([0.11, 0.02, 0.5, 0.011], [0.01] * 4, [0.05, 0.01, 0.06, 0.09], [0.19, 0.39, 0.99, 5.99], precision)
    out = run("bubble_growth", backend, a, dt=0.01, literal_radius=1)["bubble_radius"]
    birth = (3 / (16 * np.pi)) ** (1 / 3) * D
    want = [0.75 * 0.05 + 0.25 * 0.06 * 0.2, 0.75 * D + 0.25 * 0.01 * 0.4, 2 * R, birth]
    assert out == pytest.approx(np.array(want), rel=2 * rounding(precision)[0])


@everywhere
def test_only_what_is_listed_grows(backend):
    a = bubbles([0.2, 0.2], [0.01] * 2, [0.05] * 2, [1.0, 1.0])
    a["bubble_index"][0], a["bubble_count"][0] = 1, 1
    out = run("bubble_growth", backend, a, dt=0.1)
    assert out["age"].tolist() == [1.0, 1.1] and out["bubble_radius"][0] == 9.0 and out["bubble_radius"][1] > 0.01


@everywhere
@pytest.mark.parametrize("n", [0, 5, 300])
def test_largest_bubble(backend, n):
    rng = np.random.default_rng(n)
    phase = rng.choice([LIQUID, BUBBLE, VAPOUR], n)
    radius = np.where(phase == BUBBLE, rng.uniform(0.001, 0.04, n), 99.0)
    a = pool(np.arange(3 * n).reshape(n, 3), phase, "single", bubble_radius=radius)
    out = run("largest_bubble", backend, a)["largest_bubble"]
    assert out.shape == (64,) and out.max() == np.where(phase == BUBBLE, a["bubble_radius"], 0).max(initial=0)
    if n == 300:
        p = 17
        part = slice(p * n // 64, (p + 1) * n // 64)
        assert out[p] == np.where(phase[part] == BUBBLE, a["bubble_radius"][part], 0).max()
        a["bubble_radius"][np.flatnonzero(phase == BUBBLE)[3]] = np.nan
        assert run("largest_bubble", backend, a)["largest_bubble"].max() == np.inf
        a["phase"][:] = LIQUID
        assert (run("largest_bubble", backend, a)["largest_bubble"] == 0).all()
