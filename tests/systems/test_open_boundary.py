"""Open boundaries by characteristics (flood E18): each formula, its limits, and waves that leave a channel."""

import itertools
import math

import numpy as np
import pytest

from melt.errors import InputError
from melt.flood.open_boundary import boundary_state, inside_of

G = 9.81


def K(depth, velocity):
    return velocity - 2 * math.sqrt(G * depth)


def test_still_water_of_the_imposed_state_is_left_alone():
    for given in (dict(depth=2.0), dict(velocity=0.0), dict(discharge=0.0), dict(far=(2.0, 0.0))):
        state = boundary_state(2.0, 0.0, **given)
        assert (state.depth, state.velocity) == pytest.approx((2, 0), abs=1e-14) and state.regime == "subcritical"


def test_the_formulae_of_the_spec():
    d, v, root = 1.5, 0.4, math.sqrt(G)
    given = boundary_state(d, v, velocity=1.1)
    assert math.sqrt(given.depth) == pytest.approx(math.sqrt(d) + (1.1 - v) / (2 * root), rel=1e-14)
    given = boundary_state(d, v, depth=1.8)
    assert given.velocity == pytest.approx(v - 2 * root * (math.sqrt(d) - math.sqrt(1.8)), rel=1e-13)


def test_signs():
    """A higher stage outside pushes water in; more inflow stands higher; an outflow draws the water down."""
    assert boundary_state(1.0, 0.0, depth=1.2).velocity > 0 > boundary_state(1.0, 0.0, depth=0.8).velocity
    assert boundary_state(1.0, 0.0, discharge=0.5).depth > 1 > boundary_state(1.0, 0.0, discharge=-0.5).depth
    assert boundary_state(1.0, 0.0, velocity=0.5).depth > 1 > boundary_state(1.0, 0.0, velocity=-0.5).depth


@pytest.mark.parametrize("q", [-0.8, -0.1, -1e-6, 0.0, 1e-6, 0.1, 2.0, 4.0])
@pytest.mark.parametrize("v", [-1.0, 0.0, 1.5])
def test_an_imposed_discharge_is_met_on_the_outgoing_invariant(q, v):
    state = boundary_state(1.5, v, discharge=q)
    assert state.regime == "subcritical" and state.discharge == pytest.approx(q, rel=1e-12, abs=1e-300)
    assert K(state.depth, state.velocity) == pytest.approx(K(1.5, v), rel=1e-12)
    # the same state comes from its depth and from its velocity
    for given in (dict(depth=state.depth), dict(velocity=state.velocity)):
        assert boundary_state(1.5, v, **given)[:2] == pytest.approx(state[:2], rel=1e-9, abs=1e-9)


def test_a_free_fall_is_critical():
    """Nothing outside: the water leaves at v = -c with c = -K/3, which of lake water is 8/27 d sqrt(g d)."""
    for given in (dict(depth=0.0), dict(velocity=-99.0), dict(discharge=-99.0), dict(far=(0.0, 0.0))):
        state = boundary_state(1.0, 0.0, **given)
        assert state.regime == "critical out" and state.depth == pytest.approx(4 / 9, rel=1e-12)
        assert state.discharge == pytest.approx(-8 / 27 * math.sqrt(G), rel=1e-12)


def test_a_dry_bed_fills_at_the_critical_speed():
    state = boundary_state(0.0, 0.0, depth=0.5)
    assert state.regime == "critical in" and state.velocity == pytest.approx(math.sqrt(0.5 * G))
    state = boundary_state(0.0, 0.0, discharge=2.0)
    assert state.discharge == pytest.approx(2.0) and state.velocity == pytest.approx(math.sqrt(G * state.depth))
    assert boundary_state(0.0, 0.0, velocity=3.0).depth == pytest.approx(9 / G)
    # a lake that breaks into a dry channel: Ritter's state at the dam
    state = boundary_state(0.0, 0.0, far=(1.0, 0.0))
    assert (state.depth, state.velocity) == pytest.approx((4 / 9, 2 / 3 * math.sqrt(G)))
    assert boundary_state(0.0, 0.0, discharge=0.0)[:2] == (0, 0) == boundary_state(0.0, 0.0, depth=0.0)[:2]


def test_supercritical_water_out_is_copied_and_in_needs_both():
    for given in (dict(depth=0.1), dict(velocity=1.0), dict(discharge=2.0), dict(far=(0.1, 0.0))):
        assert boundary_state(0.5, -4.0, **given) == (0.5, -4.0, "supercritical out")
    assert boundary_state(0.5, 0.0, depth=0.2, velocity=3.0) == (0.2, 3.0, "supercritical in")
    assert boundary_state(0.5, 0.0, depth=0.2, discharge=0.6)[:2] == pytest.approx((0.2, 3.0))
    assert boundary_state(0.5, 0.0, far=(0.2, 3.0)) == (0.2, 3.0, "supercritical in")
    # slower than its waves: the depth is imposed, the velocity follows
    assert boundary_state(0.5, 0.0, depth=0.52, velocity=0.1) == boundary_state(0.5, 0.0, depth=0.52)


def test_states_join_where_regimes_meet():
    """Small changes of what is imposed or inside change little, from free fall through rest to critical inflow."""
    sweeps = dict(depth=np.linspace(0, 4, 4001), velocity=np.linspace(-6, 6, 6001), discharge=np.linspace(-3, 40, 8001))
    for name, values in sweeps.items():
        states = np.array([boundary_state(1.0, 0.0, **{name: v})[:2] for v in values])
        assert np.isfinite(states).all() and (states[:, 0] >= 0).all()
        assert np.abs(np.diff(states[5:], axis=0)).max() < 0.15, name


def test_bad_requests_are_refused():
    for given in ({}, dict(velocity=1.0, discharge=1.0), dict(depth=1.0, far=(1.0, 0.0))):
        with pytest.raises(InputError, match="impose"):
            boundary_state(1.0, 0.0, **given)
    for inside, given in (((1.0, np.nan), dict(depth=1.0)), ((-1.0, 0.0), dict(depth=1.0)), ((1.0, 0.0), dict(depth=-1.0))):
        with pytest.raises(InputError, match="finite"):
            boundary_state(*inside, **given)


def test_what_the_probe_says():
    assert inside_of(4.0, -3.0, 6.0) == (1.5, -0.5) and inside_of(0.0, 0.0, 0.0) == (0, 0)


def channel(depth, velocity, west, east, length, time):
    """Advance a channel (finite volumes, HLL, first order) with edges by ``west`` and ``east``; return (d, v) over time.

    An edge is a function of (time, depth, inward velocity) of the first cell that returns (depth, inward velocity).
    """
    d, q, n = depth.copy(), depth * velocity, len(depth)
    dx, t, history = length / n, 0.0, []
    while t < time:
        v = q / d
        dt = min(0.45 * dx / (np.abs(v) + np.sqrt(G * d)).max(), time - t)
        d_w, v_w = west(t, d[0], v[0])
        d_e, v_e = east(t, d[-1], -v[-1])
        D, V = np.concatenate([[d_w], d, [d_e]]), np.concatenate([[v_w], v, [-v_e]])
        c = np.sqrt(G * D)
        low = np.minimum(V[:-1] - c[:-1], V[1:] - c[1:])
        high = np.maximum(V[:-1] + c[:-1], V[1:] + c[1:])
        low, high = np.minimum(low, 0), np.maximum(high, 0)
        U = np.stack([D, D * V])
        F = np.stack([D * V, D * V**2 + 0.5 * G * D**2])
        flux = (high * F[:, :-1] - low * F[:, 1:] + low * high * (U[:, 1:] - U[:, :-1])) / (high - low)
        d, q = d - dt / dx * np.diff(flux[0]), q - dt / dx * np.diff(flux[1])
        t += dt
        history.append((t, d.copy(), q / d))
    return history


def edge(**given):
    """Return an edge for `channel`; values may be functions of time."""

    def state(t, d, v):
        return boundary_state(d, v, **{k: x(t) if callable(x) else x for k, x in given.items()})[:2]

    return state


def test_a_wave_leaves_through_an_edge_that_knows_the_water_outside():
    """A hump of 5 % on 1 m of water splits; what comes back from the eastern edge is below 5 % of it (spec E18)."""
    x = (np.arange(400) + 0.5) / 400 * 20
    hump = 0.05 * np.exp(-((x - 10) ** 2))
    still = edge(far=(1.0, 0.0))
    t = 10 / math.sqrt(G) + 2.5
    end = channel(1 + hump, 0 * x, still, still, 20.0, t)[-1]
    assert np.abs(end[1] - 1).max() < 0.05 * 0.025
    # an edge with a given depth sends it back upside down, one with a given velocity upright
    for given, sign in ((dict(depth=1.0), -1), (dict(velocity=0.0), 1)):
        mirror = edge(**given)
        back = channel(1 + hump, 0 * x, mirror, mirror, 20.0, t)[-1][1] - 1
        assert sign * back[np.abs(back).argmax()] > 0.5 * 0.025


def test_a_wave_enters_and_leaves():
    """The western edge makes waves of 2 cm; they arrive after 20 m and do not come back."""
    def swell(t):
        return 1 + 0.02 * math.sin(2 * math.pi * t / 2.0)

    x = np.zeros(600)
    waves = edge(far=lambda t: (swell(t), 2 * (math.sqrt(G * swell(t)) - math.sqrt(G))))
    history = channel(1 + x, x, waves, edge(far=(1.0, 0.0)), 20.0, 18.0)
    gauge = np.array([(t, d[300]) for t, d, _ in history if t > 10])
    crest = gauge[:, 1].max() - 1
    assert crest == pytest.approx(1 - gauge[:, 1].min(), rel=0.1) and 0.012 < crest < 0.0201
    # amplitude is even along the channel but for the decay of a first-order scheme: no standing wave
    envelope = np.array([d for t, d, _ in history if t > 12]).max(axis=0) - 1
    assert (np.diff(envelope[30:-30]) < 1e-4).all()


@pytest.mark.parametrize("q", [0.5, 2.0])
def test_a_river_comes_to_the_discharge_and_stage_of_its_ends(q):
    x = np.zeros(100)
    history = channel(1 + x, x, edge(discharge=q), edge(depth=1.2), 10.0, 120.0)
    _, d, v = history[-1]
    # both ends send waves back: those of the start decay slowly
    assert d * v == pytest.approx(np.full(100, q), rel=0.02) and d == pytest.approx(np.full(100, 1.2), rel=2e-3)


def test_a_lake_runs_dry_over_a_free_edge():
    """It falls monotonically, and the discharge is Ritter's as long as the far end does not know."""
    x = np.zeros(200)
    wall = edge(velocity=0.0)
    history = channel(1 + x, x, wall, edge(depth=0.0), 10.0, 2.0)
    volume = np.array([10.0, *(d.mean() * 10 for _, d, _ in history)])
    times = np.array([0.0, *(t for t, _, _ in history)])
    flow = -np.diff(volume) / np.diff(times)
    assert (flow > 0).all() and flow[len(flow) // 2] == pytest.approx(8 / 27 * math.sqrt(G), rel=0.02)


def test_all_states_are_finite():
    grid = (0.0, 1e-12, 0.1, 1.0, 50.0), (-30.0, -1.0, 0.0, 1.0, 30.0)
    for d, v, name, value in itertools.product(*grid, ("depth", "velocity", "discharge"), (-5.0, -1e-9, 0.0, 1e-9, 5.0)):
        if name == "depth" and value < 0:
            continue
        state = boundary_state(d, v, **{name: value})
        assert math.isfinite(state.depth) and math.isfinite(state.velocity) and state.depth >= 0
