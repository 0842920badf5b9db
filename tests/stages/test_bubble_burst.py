"""Bubbles at the surface: columns, who leaves, the push of a burst (boiling 2.5, eq (14); V20)."""

import numpy as np
import pytest
from bubble_cases import BUBBLES
from bubble_life_cases import (
    BUBBLE,
    CELL,
    GRID,
    INACTIVE,
    LIQUID,
    bubbles,
    listed,
    merge,
    pool,
    run,
    shuffled,
    slots_of,
)
from liquid_cases import both, everywhere
from pbf_cases import D

REACH, SIDE, UP = BUBBLES["push_reach"], BUBBLES["push_side"], BUBBLES["push_up"]
SMALL = BUBBLES["burst_radius"]
Q = 2.0**-6
NX = GRID["nx"]


def at_surface(x, r, top, precision="double", **fields):
    """Bubbles under one liquid particle for each at height ``top``, listed."""
    x = np.asarray(x, float).reshape(-1, 3)
    above = np.column_stack([x[:, :2], np.broadcast_to(top, len(x))])
    n = len(x)
    given = dict(bubble_radius=np.concatenate([np.broadcast_to(r, n), np.zeros(n)]))
    return pool(np.concatenate([x, above]), np.repeat([BUBBLE, LIQUID], n), precision, **{**given, **fields})


def leave(backend, a, height=10.0, **changes):
    """Run the stages of the surface as the page does; return the slots of the bursts."""
    listed(backend, a, "phase", BUBBLE, "bubble")
    run("surface_column", backend, a, **changes)
    run("burst_test", backend, a, height=height, **changes)
    burst = listed(backend, a, "bubble_fate", 2, "burst")
    run("burst_push", backend, a, **changes)
    run("remove_bubbles", backend, a)
    return burst


@everywhere
@both
def test_columns_by_hand(backend, precision):
    """The highest liquid in 1/4096 of a spacing, to the nearest; other phases do not count, ends clamp."""
    s = 2.0**-12 * 2 * Q
    z = [5 * s, 9.25 * s, 7 * s, 9.75 * s, 999 * s, 999 * s, -3 * s, 2.0**24, np.nan]
    x = [0.5, 1.5, 1.5, 2.5, 0.5, 1.5, -9, 99, 4.5]
    y = [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 1.5, 99, 0.5]
    phase = [0, 0, 0, 0, 3, 4, 0, 0, 0]
    a = pool(np.column_stack([np.array(x) * CELL, np.array(y) * CELL, z]), phase, precision)
    run("surface_column", backend, a, spacing=2 * Q)
    expected = np.full(a["surface_column"].size, -1)
    expected[[0, 1, 2, NX, NX - 1 + NX * 6, 4]] = [5, 9, 10, 0, 2**30, 0]
    assert a["surface_column"].tolist() == expected.tolist()
    run("surface_column", backend, a, spacing=2 * Q, floor=-3 * s)
    assert a["surface_column"][[0, 1, NX]].tolist() == [8, 12, 0]


@everywhere
def test_highest_of_many(backend):
    rng = np.random.default_rng(0)
    x = rng.uniform(0, 7 * CELL, (2000, 3))
    phase = rng.choice([0, 0, 0, 3, 5], 2000)
    a = pool(x, phase)
    run("surface_column", backend, a)
    cell = (x[:, :2] / CELL).astype(int)
    for c in range(a["surface_column"].size):
        on = (cell[:, 0] + NX * cell[:, 1] == c) & (phase == 0)
        assert a["surface_column"][c] == (int(x[on, 2].max() * 4096 / D + 0.5) if on.any() else -1)


@everywhere
@both
def test_who_leaves_by_hand(backend, precision):
    """z + r >= top, small ones vanish, large ones burst; no liquid above lets all go; the height is bounded."""
    top = 8 * Q  # 32 spacings of Q/4: a whole number of steps
    x = [[0.5 * CELL + k * CELL, 0.5 * CELL, z] for k, z in enumerate([7 * Q, 7 * Q, 7 * Q - 2.0**-16, 2 * Q, 7.5 * Q, 3 * Q])]
    r = [Q, Q, Q, Q, Q / 2, 0]
    a = at_surface(x, r, top, precision)
    a["phase"][6 + 3] = INACTIVE  # the fourth has no liquid above it
    run("surface_column", backend, a, spacing=Q / 4)
    listed(backend, a, "phase", BUBBLE, "bubble")
    run("burst_test", backend, a, height=10.0, spacing=Q / 4, burst_radius=Q / 2)
    assert a["bubble_fate"].tolist() == [2, 2, 0, 2, 1, 0] + [0] * 6
    assert a["burst_top"].tolist() == [top, top, top, 2 * Q, top, 0] + [0] * 6
    # a splash does not count: above H + R the surface is H + R; the radius Q is small now
    run("burst_test", backend, a, height=7 * Q, spacing=Q / 4, burst_radius=Q)
    assert a["bubble_fate"].tolist() == [1, 1, 1, 1, 1, 0] + [0] * 6
    assert a["burst_top"][:5].tolist() == [7 * Q] * 3 + [2 * Q, 7 * Q]
    # the floor is where heights begin
    run("burst_test", backend, a, height=7 * Q, spacing=Q / 4, burst_radius=Q / 2, floor=Q)
    assert a["burst_top"][:5].tolist() == [8 * Q] * 3 + [2 * Q, 8 * Q]
    assert a["bubble_fate"].tolist() == [2, 2, 0, 2, 1, 0] + [0] * 6


@everywhere
def test_fates_of_the_last_step_are_forgotten(backend):
    """What burst before, and what merged away in this step, is in no list again."""
    a = at_surface([[0.1, 0.1, 0.1]] * 3, SMALL * 2, 0.5)
    a["phase"][0], a["bubble_fate"][:], a["burst_top"][:] = INACTIVE, 2, 7
    a["bubble_radius"][1] = 0  # merged away: still listed, at the surface
    a["position"][2, 1] = 0.6
    a["bubble_index"][:2], a["bubble_count"][0] = [1, 2], 2
    run("surface_column", backend, a)
    run("burst_test", backend, a, height=10.0)
    assert a["bubble_fate"].tolist() == [0] * 6 and a["burst_top"].tolist() == [0, 0, 0.5, 0, 0, 0]


@everywhere
@both
def test_push_by_hand(backend, precision):
    """Eq (14) for one particle: w = 1 - q, and w = 1 with ``push_even``; nothing from q = 1 on, nothing for bubbles."""
    top = 0.25
    d = np.array([0.3, -0.4, -1.2]) * REACH / 2.6  # |d| = REACH/2
    out = np.array([0, 0, -1.0]) * REACH * (1 + 1e-6)
    x = [[0.2, 0.2, 0.2]] + [np.array([0.2, 0.2, top]) + v for v in (d, d * [1, 1, -1], out, d, d)]
    start = np.arange(18.0).reshape(3, 6) / 8
    a = pool(x, [BUBBLE, 0, 0, 0, BUBBLE, 2], precision, velocity=start, burst_top=[top] + [0] * 5)
    a["burst_index"][0], a["burst_count"][0] = 0, 1
    for even, w in ((0, 0.5), (1, 1.0)):
        a["velocity"][:] = start
        run("burst_push", backend, a, push_even=even)
        dv = np.array([SIDE * d[0], SIDE * d[1], UP * abs(d[2])]) * w  # both above and below go up
        rel = 2e-6 if precision == "single" else 1e-12
        assert a["velocity"][:, 1] - start[:, 1] == pytest.approx(dv, rel=rel, abs=1e-6 if precision == "single" else 0)
        assert a["velocity"][:, 2] - start[:, 2] == pytest.approx(dv, rel=rel, abs=1e-6 if precision == "single" else 0)
        assert (a["velocity"][:, 3:] == start[:, 3:]).all()


@everywhere
def test_ring_of_liquid(backend):
    """V20: the horizontal impulses of a ring sum to 0, the vertical are positive, and w falls to 0 at q = 1."""
    n, top = 12, 0.3
    turn = 2 * np.pi * np.arange(n) / n
    speeds = []
    for q in (0.25, 0.5, 0.999999999, 1.0):
        side, down = 0.8 * q * REACH, 0.6 * q * REACH
        ring = np.column_stack([0.2 + side * np.cos(turn), 0.2 + side * np.sin(turn), np.full(n, top - down)])
        r = 2 * SMALL
        a = pool(np.vstack([ring, [0.2, 0.2, top - r]]), [LIQUID] * n + [BUBBLE], bubble_radius=[0] * n + [r])
        a["burst_index"][0], a["burst_count"][0], a["burst_top"][n] = n, 1, top
        run("burst_push", backend, a)
        v = a["velocity"][:, :n]
        outward = v[0] * np.cos(turn) + v[1] * np.sin(turn)
        assert np.abs(v[:2].sum(axis=1)).max() <= 1e-12 * SIDE * REACH
        assert outward == pytest.approx(SIDE * side * (1 - q), rel=1e-6, abs=1e-12)
        assert v[2] == pytest.approx(UP * down * (1 - q), rel=1e-6, abs=1e-12)
        speeds.append(v[2].min())
    assert speeds[0] > 0 and speeds[1] > 0 and speeds[2] < 1e-7 and speeds[3] < 1e-12


@everywhere
@both
def test_small_bubbles_vanish_without_a_push(backend, precision):
    """r = r_s does not push, a hair more does; both are counted with their cargo, and keep their fields for the step."""
    real = np.float32 if precision == "single" else np.float64
    for r, fate in ((real(SMALL), 1), (np.nextafter(real(SMALL), real(1)), 2)):
        a = at_surface([[0.2, 0.2, 0.2]], float(r), 0.2 + 0.5 * SMALL, precision, cargo=[6, 0])
        a["position"][0, 1] += real(0.1 * D)
        kept = {name: a[name].copy() for name in ("position", "bubble_radius", "cargo", "id")}
        burst = leave(backend, a)
        assert burst.size == fate - 1 and a["bubble_fate"][0] == fate
        assert a["released"].sum(axis=1).tolist() == [2 - fate, fate - 1, 6]
        assert a["phase"].tolist() == [INACTIVE, LIQUID]
        assert (a["velocity"][:, 1] != 0).any() == (fate == 2)
        assert all((a[name] == value).all() for name, value in kept.items())


@everywhere
@both
def test_several_bursts_add_up_in_the_order_of_ids(backend, precision):
    """The same bits wherever the bubbles are stored; the sum of what each would do alone."""
    rng = np.random.default_rng(3)
    n, m = 200, 9
    x = np.vstack([rng.uniform(0.1, 0.2, (n, 3)), rng.uniform(0.12, 0.18, (m, 3))])
    fields = dict(burst_top=np.r_[np.zeros(n), x[n:, 2] + 0.01], id=rng.permutation(n + m), velocity=rng.normal(size=(3, n + m)))
    a = pool(x, np.repeat([LIQUID, BUBBLE], [n, m]), precision, **fields)
    a["bubble_fate"][n:] = 2
    alone = np.zeros((3, n))
    for b in range(n, n + m):
        one = {name: value.copy() for name, value in a.items()}
        one["burst_index"][0], one["burst_count"][0] = b, 1
        run("burst_push", backend, one)
        alone += one["velocity"][:, :n].astype(float) - a["velocity"][:, :n]
    start = a["velocity"][:, :n].astype(float)
    order = rng.permutation(n + m)
    other = shuffled(a, order)
    for b in (a, other):
        listed(backend, b, "bubble_fate", 2, "burst")
        run("burst_push", backend, b)
    rel, least = (1e-4, 1e-5) if precision == "single" else (1e-12, 1e-13)
    assert a["velocity"][:, :n] - start == pytest.approx(alone, rel=rel, abs=least)
    assert np.ascontiguousarray(a["velocity"][:, order]).tobytes() == other["velocity"].tobytes()


@everywhere
def test_removal_counts_every_bubble_once(backend):
    """More bubbles than pieces: fates and cargo are counted exactly, and the others stay."""
    rng = np.random.default_rng(7)
    for n in (0, 1, 63, 64, 1003):
        fate, cargo = rng.integers(0, 3, n), rng.integers(0, 2**20, n)
        a = pool(np.zeros((n, 3)), BUBBLE, bubble_fate=fate, cargo=cargo, id=rng.permutation(n))
        a["released"][:] = -5
        listed(backend, a, "phase", BUBBLE, "bubble")
        run("remove_bubbles", backend, a)
        assert a["released"].sum(axis=1).tolist() == [(fate == 1).sum(), (fate == 2).sum(), cargo[fate > 0].sum()]
        assert (a["phase"] == np.where(fate > 0, INACTIVE, BUBBLE)).all()


@everywhere
@both
def test_cargo_through_merging_and_bursting(backend, precision):
    """Quarters: those of bubbles and those released stay a constant (V21, bubble part)."""
    rng = np.random.default_rng(9)
    n = 300
    a = bubbles(rng.uniform(0.05, 0.3, (n, 3)), 0.008, precision, id=rng.permutation(n), cargo=rng.integers(1, 5, n))
    quarters, released = int(a["cargo"].sum()), 0
    for height in (0.3, 0.25, 0.2, 0.1, 0.0):
        merge(backend, a)
        leave(backend, a, height=height)
        released += int(a["released"][2].sum())
        assert released + int(a["cargo"][slots_of(a, BUBBLE)].sum()) == quarters
    assert slots_of(a, BUBBLE).size == 0 and released == quarters
