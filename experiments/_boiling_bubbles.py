"""Bubbles put into a liquid at rest: rise (V16), merging over 10 s (V18), the benchmark of Hysing et al."""

import contextlib
import csv
import math
import pathlib

import numpy as np

from melt.geometry.build import build
from melt.physics.phases import BUBBLE, INACTIVE, LIQUID
from melt.scene import scene_from_dict
from melt.simulation import Simulation
from melt.systems import bubbles as page

D, G, REACH = 0.02, 9.81, 2.2
DATA = pathlib.Path(__file__).parents[1] / "data" / "measured" / "hysing_2009_rising_bubble.csv"
#: Gas density [kg/m^3] of the benchmark's cases; both have 1000 kg/m^3 of liquid, r = 0.25 m, g = 0.98 m/s^2, 1 m x 2 m.
HYSING = {1: 100.0, 2: 1.0}


def tank(cells, spacing=D, gravity=G, bubbles=None, headroom=0.5, dt=1 / 240, n_sub=1):
    """Return a scene of liquid that does not boil; its bubbles do not grow unless told."""
    size = [c * spacing for c in cells]
    return scene_from_dict({
        "time": {"end": 100.0, "dt": dt, "n_sub": n_sub, **({"n_sub_max": 64} if n_sub == "auto" else {})},
        "domain": {"upper": [*size[:2], (1 + headroom) * size[2]], "spacing": spacing, "gravity": [0, 0, -gravity]},
        "fluid": {"temperature": 20.0, "fill": [{"lower": [0, 0, 0], "upper": size}]},
        "solver": {"pressure": "pbf", "precision": "double", "support": REACH},
        "boiling": {"boost": "off", "bubbles": {"beta": 0.0, **(bubbles or {})}},
    })


def settled(scene, seconds):
    """Return positions (3, n) [m] of the liquid after a rest."""
    sim = Simulation(scene, "cpu")
    for _ in range(round(seconds / scene.time.dt)):
        sim.step()
    return sim.read("position")[sim.read("phase") == LIQUID].T


def with_bubbles(scene, liquid, centres, radii, cargo=0):
    """Return the initial state with liquid at ``liquid`` (3, n) and bubbles at ``centres`` (3, m), at rest.

    The particles nearest to a bubble, in number those that it displaces, go to free places above the surface.
    """
    initial, d = build(scene), scene.spacing
    x, volume = liquid.copy(), 4 / 3 * np.pi * np.asarray(radii, float) ** 3
    spots = _above(x, d, int(np.rint(volume.sum() / d**3)) + len(volume))
    for centre, v in zip(centres.T, volume):
        for i in np.argsort(((x - centre[:, None]) ** 2).sum(axis=0))[: int(np.rint(v / d**3))]:
            x[:, i] = spots.pop()
    a = initial.arrays
    a["position"][:, : x.shape[1]] = x
    slots = np.flatnonzero(a["phase"] == INACTIVE)[: len(volume)]
    n = a["phase"].size
    a["phase"][slots], a["position"][:, slots] = BUBBLE, centres
    a["rest_volume"][slots] = np.minimum(volume, 4.2 * d**3)
    given = (("bubble_volume", volume, float), ("bubble_radius", radii, float), ("birth_height", centres[2], float),
             ("cargo", np.full(len(volume), cargo), np.int32))
    for name, values, kind in given:
        a[name] = np.zeros(n, kind)
        a[name][slots] = values
    a["age"] = np.zeros(n)
    return initial


def _above(x, d, number):
    """Return places [m] on a lattice above the highest liquid."""
    low, high = x.min(axis=1), x.max(axis=1)
    along = [np.arange(low[k], high[k] + d / 2, d) for k in (0, 1)]
    layers = math.ceil(number / (along[0].size * along[1].size)) or 1
    up = high[2] + d * (1 + np.arange(layers))
    return [np.array(p) for p in np.stack(np.meshgrid(*along, up, indexing="ij"), -1).reshape(-1, 3)]


def around(sim, b):
    """Return the velocity of the liquid around slot b, weighted with poly6 [m/s]."""
    x, v = sim.state.read("position"), sim.state.read("velocity")
    liquid = sim.state.read("phase") == LIQUID
    q2 = ((x[:, liquid] - x[:, b, None]) ** 2).sum(axis=0) / (REACH * sim.scene.spacing) ** 2
    w = np.maximum(1 - q2, 0) ** 3
    return (w * v[:, liquid]).sum(axis=1) / w.sum() if w.sum() > 0 else np.zeros(3)


def rise(scene, initial, bottom, top, longest=10.0):
    """Let the one bubble rise from ``bottom`` to ``top`` [m]; return times, heights, speed, relative speed, largest C."""
    sim, found = Simulation(scene, "cpu", initial=initial), []
    while sim.time < longest:
        sim.step()
        b = np.flatnonzero(sim.state.read("phase") == BUBBLE)
        if not b.size or sim.state.read("position")[2, b[0]] > top:
            break
        z, v = float(sim.state.read("position")[2, b[0]]), sim.state.read("velocity")[:, b[0]].astype(float)
        C = sim.state.read("constraint")[sim.state.read("phase") == LIQUID].max()
        found.append((sim.time, z, v[2], np.linalg.norm(v - around(sim, b[0])), C))
    t, z, v, relative, C = np.array(found).T
    return t, z, v, relative, np.where(z > bottom, C, 0.0)


def risen(ratio, cells, starts, liquid=None):
    """V16: return the means of a bubble of ``ratio`` spacings that rises through a resting column."""
    scene = tank(cells)
    x = settled(scene, 1.0) if liquid is None else liquid
    height, found = x[2].max(), []
    for k in range(starts):
        shift = (np.array([k % 2, k // 2]) - 0.25 * (starts > 1)) * 0.7 * D
        centre = np.array([[cells[0] * D / 2 + shift[0]], [cells[1] * D / 2 + shift[1]], [3 * D]])
        t, z, v, relative, C = rise(scene, with_bubbles(scene, x, centre, np.array([ratio * D])), 5 * D, height - 3 * D)
        inside = (z > 5 * D) & (t > 0.1)
        found.append(((z[inside][-1] - z[inside][0]) / (t[inside][-1] - t[inside][0]), relative[inside].mean(), C.max()))
    speed, relative, C = np.array(found).T
    return {"ratio": ratio, "speed": speed.mean(), "relative": relative.mean(), "C": C.max(), "law": math.sqrt(G * ratio * D),
            "liquid": x.shape[1], "starts": starts}


@contextlib.contextmanager
def merging_seen(found):
    """Put (volume before, volume after, cargo before, cargo after) of every merging of bubbles into ``found``."""
    original = page.merge

    def merge(do):
        if not hasattr(do, "state"):  # the plan asks for names only
            return original(do)
        before = _totals(do.state)
        original(do)
        found.append((*before, *_totals(do.state)))

    page.merge = merge
    try:
        yield
    finally:
        page.merge = original


def _totals(state):
    on = state.read("phase") == BUBBLE
    return math.fsum(4 / 3 * np.pi * state.read("bubble_radius")[on].astype(float) ** 3), int(state.read("cargo")[on].sum())


def cascade(cells, number, seconds, seed=4):
    """V18: many bubbles rise slowly (g = 0.02 m/s^2), grow and merge; return the ledger of it."""
    laws = {"beta": 2.5, "merge_age": 0.1, "drift": 0.3}  # ten times the growth
    scene = tank(cells, gravity=0.02, bubbles=laws, dt=1 / 60)
    rng = np.random.default_rng(seed)
    size = np.array(cells) * D
    room = np.array([size[0], size[1], 0.3 * size[2]])
    centres = rng.uniform(0.1, 0.9, (3, number)) * room[:, None]
    radii = rng.uniform(0.25, 0.6, number) * D
    initial = with_bubbles(scene, build(scene)["position"][:, : math.prod(cells)], centres, radii, cargo=3)
    found = []
    with merging_seen(found):
        sim = Simulation(scene, "cpu", initial=initial)
        for _ in range(round(seconds / scene.time.dt)):
            sim.step()
    s, found = sim.series(), np.array(found)
    V0, Q0, V1, Q1 = found.T
    cargo = int(sim.read("cargo")[sim.read("phase") == BUBBLE].sum()) + sim.do.clock.ledger["released_quarters"]
    return {
        "merged": s["merged"], "left": s["bubbles"], "gone": s["burst"] + s["vanished"], "bubbles": number,
        "cargo_missing": cargo - 3 * number, "cargo_changed": int(np.abs(Q1 - Q0).max()),
        "volume_error": float(np.abs(V1 / V0 - 1).max()), "growth": float(s["bubble_volume"] / (4 / 3 * np.pi * (radii**3).sum())),
        "liquid": math.prod(cells), "steps": len(found),
    }


def benchmark():
    """Return {case: (t, y_c, v)} of the reference (arrays), s, m, m/s."""
    with open(DATA, newline="") as file:
        rows = [[float(v) for v in row] for row in list(csv.reader(file))[1:]]
    return {case: np.array([r[1:] for r in rows if r[0] == case]).T for case in HYSING}


def drag_of(case, speed):
    """Return C_D whose terminal speed sqrt(8 r g (rho - rho_g)/(3 C_D rho)) is ``speed``."""
    return 8 * 0.25 * 0.98 * (1 - HYSING[case] / 1000) / (3 * speed**2)


def hysing(case, drag, cells=8):
    """Let a sphere of r = 0.25 m rise from 0.5 m in a box of 1 x 1 x 2 m, ``cells`` spacings wide.

    Return (t, z, v, speed in the liquid around) until t = 3 s or the surface.
    """
    d = 1 / cells
    laws = {"drag": drag, "gas_density": HYSING[case]}
    scene = tank((cells, cells, 2 * cells), d, 0.98, laws, dt=1 / 60, n_sub="auto")
    x = settled(scene, 2.0)
    initial = with_bubbles(scene, x, np.array([[0.5], [0.5], [0.5]]), np.array([0.25]))
    return np.array(rise(scene, initial, 0.6, x[2].max() - 0.3, 3.0)[:4])
