"""Scenes and measures of `experiments.flood_control`."""

import pathlib
import tempfile

import numpy as np
from scipy.spatial import cKDTree

from melt.geometry.build import build
from melt.geometry.outlines import inside
from melt.physics.phases import LIQUID
from melt.scene import load_scene, scene_from_dict
from melt.simulation import Simulation

G, EVEN, R0 = 9.81, 22, 0.25
OWN_POINT = {"slope_on": 0.3, "slope_full": 0.6, "clamp": False, "spread": 1e-6}
#: Of the cliff table: what the control force is, None for none.
VARIANTS = {
    "off": None,
    "own point": OWN_POINT,
    "4 points, l = h (paper)": {"clamp": False, "spread": 1.0},
    "4 points, l <= 2 r0": {"spread": 1.0},
    "4 points, l = 0.25 h (default)": {},
}
ALWAYS = {"slope_on": 0.0, "slope_full": 0.0}


def water(sim, *names):
    """Return fields of the columns on the terrain, in order of id, in float64."""
    here = sim.read("phase") == LIQUID
    return [sim.read(name)[here].astype(np.float64) for name in names]


def with_control(scene, control):
    """Return a scene with that [control] (a dictionary), or without."""
    from melt.scene.flood import Control

    return scene.model_copy(update={"control": None if control is None else Control(**control)})


# ---- VC1, VC2: where nothing is steep nothing changes


def gentle(quick):
    """Return {name: scene} of floods whose beds are nowhere steeper than slope_on = 0.3."""
    r0, end = ("0.25", "0.3") if quick else ("0.1", "1.5")
    bump = {
        "time": {"end": float(end), "dt": 0.05, "n_sub_max": 100},
        "terrain": {
            "shape": "smooth_bump",
            "lower": [0, 0],
            "upper": [12, 2],
            "cell": 0.25,
            "parameters": {"height": 0.2, "width": 2.5, "centre": [7.0, 1.0], "dimension": 2},
        },
        "fluid": {"spacing": float(r0), "reference_depth": 0.5, "fill": [{"upper": [4, 2], "lower": [0, 0], "depth": 1.0}]},
    }
    found = {name: load_scene(name, [f"fluid.spacing={r0}", f"time.end={end}"]) for name in ("ritter", "stoker")}
    found["smooth bump"] = scene_from_dict(bump)
    found["Thacker 2-D"] = load_scene("parabolic_bowl", [f"time.end={end}"])
    return found


def identical(scene):
    """Return (whether runs with and without control agree bit by bit, the largest brake [m/s^2], steepest slope met)."""
    ends, brake, slope = [], 0.0, 0.0
    initial = build(scene)
    for control in (None, {}):
        sim = Simulation(with_control(scene, control), "cpu", initial=initial)
        for _ in range(scene.time.steps):
            sim.step()
            if control is not None:
                brake = max(brake, float(np.abs(water(sim, "brake")[0]).max()))
                slope = max(slope, float(np.linalg.norm(water(sim, "bed_slope")[0], axis=-1).max()))
        ends.append(water(sim, "position", "velocity", "depth"))
    same = all(np.array_equal(a, b) for a, b in zip(*ends))
    return {"same": same, "brake": brake, "slope": slope, "columns": len(ends[0][2]), "steps": scene.time.steps}


def steep_bowl(control, r0=0.05, periods=1.0):
    """Return (time [s], centre of the water [m]) of Thacker's channel h0 = 0.5, a = 1, slopes up to 1.5."""
    scene = scene_from_dict(
        {
            "time": {"end": 2.006067 * periods, "dt": 0.02, "n_sub_max": 100},
            "terrain": {
                "shape": "bowl",
                "lower": [-2, -0.25],
                "upper": [2, 0.25],
                "cell": 0.05,
                "parameters": {"depth": 0.5, "radius": 1.0, "dimension": 1},
            },
            "fluid": {"spacing": r0, "reference_depth": 0.5, "fill": [{"profile": "thacker_channel"}]},
            "output": {"maps": False},
            "solver": {"precision": "double"},
        }
        | ({} if control is None else {"control": control})
    )
    sim, times, centre = Simulation(scene, "cpu"), [], []
    for _ in range(scene.time.steps):
        sim.step()
        x, V = water(sim, "position", "rest_volume")
        times.append(sim.time)
        centre.append(float((x[:, 0] * V).sum() / V.sum()))
    return np.array(times), np.array(centre)


# ---- VC3-VC6: single columns


def bead(slope, control, dt=0.01, steps=20, shape=None):
    """Return a simulation of one column on a long plane of that slope, after some steps (from rest)."""
    bed = shape or {"shape": "plane", "parameters": {"slope": slope}}
    scene = scene_from_dict(
        {
            "time": {"end": steps * dt, "dt": dt, "n_sub": 1},
            "terrain": {"lower": [-40, -20], "upper": [40, 20], "cell": 0.25, **bed},
            "fluid": {"spacing": 1.0, "fill": [{"centre": [-10, 0], "radius": 0.55, "depth": 1.0}], "even": False},
            "boundary": dict.fromkeys(("west", "east", "south", "north"), "open") | {"columns": False},
            "output": {"maps": False},
            "solver": {"precision": "double", "top_speed": 1000.0},
        }
        | ({} if control is None else {"control": control})
    )
    sim = Simulation(scene, "cpu")
    for _ in range(steps):
        sim.step()
    return sim


def bead_acceleration(slope, control):
    """Return the horizontal acceleration [m/s^2] of a column that slides down a plane, between steps 10 and 20."""
    sim = bead(slope, control, steps=10)
    before = water(sim, "velocity")[0][0, 0]
    for _ in range(10):
        sim.step()
    return float((water(sim, "velocity")[0][0, 0] - before) / (10 * sim.scene.time.dt))


def brake_after(dt, time=0.8):
    """Return the brake [m/s^2] of a column that slid over a smooth hill for some time, in steps of dt."""
    hill = {"shape": "smooth_bump", "parameters": {"height": 8.0, "width": 14.0, "centre": [-16.0, 0.0], "dimension": 1}}
    return float(water(bead(0.0, ALWAYS, dt, round(time / dt), hill), "brake")[0][0])


def gains(scene):
    """Return the largest growth of a column's speed by friction and control together, over a run [m/s] (VC6)."""
    sim, most = Simulation(scene, "cpu"), [-np.inf]
    drag = sim.do.flood_drag

    def watched(**scalars):
        before = np.hypot(*sim.state.read("velocity")[:2].astype(np.float64))
        drag(**scalars)
        most[0] = max(most[0], float((np.hypot(*sim.state.read("velocity")[:2].astype(np.float64)) - before).max()))

    sim.do.flood_drag = watched
    for _ in range(scene.time.steps):
        sim.step()
    return most[0]


# ---- VC7 and the cliff table: a plateau with water 1 m deep that runs over a cliff


def cliff_bed(run, cell, edge=20.0, length=50.0, width=1.5):
    """Return (elevation (ny, nx), x of the columns) of a plateau at 10 m, a cosine drop over ``run`` m, a pit, a plain."""
    x = (np.arange(round(length / cell)) + 0.5) * cell
    fall = np.clip((x - edge) / run, 0, 1) if run > 0 else (x >= edge).astype(float)
    b = 5.0 * (1 + np.cos(np.pi * fall))
    pit = np.clip((x - edge - run) / 10.0, 0, 1)
    b -= 1.0 * (1 - np.cos(2 * np.pi * pit))
    return np.tile(b, (max(3, round(width / cell)), 1)), x


def cliff_scene(control, run=5.0, cell=0.25, r0=R0, end=12.0):
    """Return the scene of a variant; the bed goes through a file, as a user's would."""
    b, x = cliff_bed(run, cell)
    y = (np.arange(len(b)) + 0.5) * cell
    path = pathlib.Path(tempfile.mkdtemp()) / "cliff.npz"
    np.savez(path, elevation=b, x=x, y=y)
    return scene_from_dict(
        {
            "time": {"end": end, "dt": 0.05, "n_sub_max": 400},
            "terrain": {"file": str(path)},
            "fluid": {
                "spacing": r0,
                "seed": 1,
                "fill": [{"lower": [0, 0], "upper": [20, 2 * width_of(b, cell)], "depth": 1.0}],
            },
            "output": {"maps": False},
            "solver": {"kernel": "cubic"},  # of the specification's prototype, beside which the table stands
        }
        | ({} if control is None else {"control": control})
    )


def width_of(b, cell):
    """Return the width [m] of the strip."""
    return len(b) * cell


def over_cliff(control, run=5.0, cell=0.25, r0=R0, end=12.0, edge=20.0, window=(2.0, 5.5)):
    """Run a variant; return its figures.

    discharge: per width over the edge of the plateau [m^2/s], mean over a time before the wave that runs back has reached the
    wall: there it is steady, 8/27 h sqrt(g h) by Ritter's solution, since what is beyond a free fall cannot act back.
    """
    scene = cliff_scene(control, run, cell, r0, end)
    sim = Simulation(scene, "cpu")
    lowest, fastest, energy, volume, times = 0.0, 0.0, 0.0, [], []
    width = float(np.ptp(sim.initial.terrain.bounds[:, 1]))
    for _ in range(scene.time.steps):
        sim.step()
        x, v, d, b, s, V = water(sim, "position", "velocity", "depth", "bed", "bed_slope", "rest_volume")
        v2 = (v[:, :2] ** 2).sum(axis=1)
        fastest = max(fastest, float(np.sqrt(v2.max())))
        energy = max(energy, float((0.5 * v2 * (1 + (s[:, :2] ** 2).sum(axis=1)) + G * (b - lowest + 0.5 * d)).max()))
        volume.append(V[x[:, 0] < edge].sum() / width)
        times.append(sim.time)
    volume, times = np.array(volume), np.array(times)
    steady = (times >= window[0]) & (times <= window[1])
    rate = -np.polyfit(times[steady], volume[steady], 1)[0] if steady.sum() > 2 else np.nan
    top = G * (12.0 + 0.5)  # above the bottom of the pit, the terrain's datum
    arrival = next((float(t) for t, w in zip(times, volume) if w < 20 - 0.25), np.nan)
    return {
        "speed": fastest,
        "energy": energy / top,
        "plateau": float(volume[-1]),
        "discharge": float(rate),
        "arrival": arrival,
        "columns": len(x),
        "left": float(sim.series()["volume_error"]),
    }


# ---- Figure 8 and 9


def metrics(sim, start):
    """Return what the paper's figures show, as numbers. ``start``: largest energy per mass at the start, and drop [m]."""
    x, v, d, b, s, h, count = water(
        sim, "position", "velocity", "depth", "bed", "bed_slope", "support_radius", "neighbour_count"
    )
    tree = cKDTree(x[:, :2])
    near = tree.query(x[:, :2], 2)[0][:, 1]
    mean = np.stack([v[js, :2].mean(axis=0) for js in tree.query_ball_point(x[:, :2], h)])
    spread = np.sqrt(((v[:, :2] - mean) ** 2).sum(axis=1) / (G * d))
    v2 = (v[:, :2] ** 2).sum(axis=1)
    energy = 0.5 * v2 * (1 + (s[:, :2] ** 2).sum(axis=1)) + G * (b + 0.5 * d)
    return {
        "deepest": d.max(),
        "deep": np.percentile(d, 99.9),
        "crowded": (count > 2 * EVEN * sim.scene.solver.growth**2).mean(),
        "closest": near.min() / sim.scene.spacing,
        "alone": (count < 3).mean(),
        "dispersion": np.sqrt((spread**2).mean()),
        "too_fast": (v2 > 2 * G * start["drop"]).mean(),
        "fastest": np.sqrt(v2.max()),
        "energy": energy.max() / start["energy"],
    }


def rough(overrides, quick):
    """Run rough_terrain, changed; return the worst of each metric over time, and what it costs."""
    scene = load_scene(
        "rough_terrain", [*overrides, *(["time.end=1", "fluid.spacing=3"] if quick else [])], "small" if quick else None
    )
    sim = Simulation(scene, "cpu")
    d, b, x0 = water(sim, "depth", "bed", "position")
    middle = np.array([128.0, 128.0])
    start = {"energy": float(G * (b + 0.5 * d).max()), "drop": float((b + d).max())}
    found, wetted = [], np.nan
    for step in range(scene.time.steps):
        sim.step()
        if (step + 1) % scene.time.output_steps == 0 or step + 1 == scene.time.steps:
            found.append(metrics(sim, start))
        r = np.linalg.norm(water(sim, "position")[0][:, :2] - middle, axis=1)
        if np.isnan(wetted) and (r > 60.0).mean() > 0.01:
            wetted = sim.time
    least = {"closest"}
    worst = {name: float((min if name in least else max)(f[name] for f in found)) for name in found[0]}
    x = water(sim, "position")[0]
    r = np.linalg.norm(x[:, :2] - middle, axis=1)
    return worst | {
        "reach": float(np.percentile(r, 95)),
        "arrival": wetted,
        "columns": len(r),
        "end": sim.time,
        "sub_steps": sim.do.clock.sub_step,
        "error": sim.series()["volume_error"],
    }


def inside_obstacles(quick, r0=None):
    """Run obstacles; return how many columns were ever inside of one, and how deep the water stood before it and behind."""
    scene = load_scene("obstacles", ["time.end=3"] if quick else ["time.end=20"], "small" if quick or r0 is None else None)
    if r0 is not None:
        scene = load_scene("obstacles", [f"fluid.spacing={r0}", "time.end=20"])
    sim, count, looks, deepest = Simulation(scene, "cpu"), 0, 0, 0.0
    for _ in range(scene.time.steps):
        sim.step()
        x, d = water(sim, "position", "depth")
        for obstacle in scene.obstacle:
            count += int(inside(obstacle, sim.initial.terrain.world(x[:, :2].T)).sum())
        before = (np.abs(x[:, 0] - 80) < 4) & (np.abs(x[:, 1] - 26) < 5)
        deepest = max(deepest, float(d[before].max(initial=0.0)))
        looks += len(x)
    s = sim.series()
    return {
        "inside": count,
        "looks": looks,
        "columns": len(d),
        "lost": s["lost_particles"],
        "error": s["volume_error"],
        "before": deepest,
    }
