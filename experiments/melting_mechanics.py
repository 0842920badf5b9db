"""Mechanics of melting scenes: hydrostatics, buoyancy, floating depth (V10, V12, V13).

V10: a column 20 spacings deep, damped for 1 s and then left alone for 2 s: slope of the pressure inside, pressure
of the bottom layer, rms over p_max, and the speed that remains. V12: force on a fixed, submerged cube over its
displaced weight. V13: draft of floating cubes by volume balance; light bodies float, heavy ones sink.

The slope: on the lattice -(1/3) sum V r W' is 0.982 for the cubic spline at h = 2.5 spacings, so that liquid at rest
needs a pressure gradient 1.018 times rho g, and a little more where it is compressed. The motion that is left is that
lattice rearranging; the row after 10 s shows where it goes.
"""

import h5py
import numpy as np

from experiments import Row
from melt.scene import scene_from_dict
from melt.simulation import Simulation

DX = 0.2
G = 9.81


def tank(cells, depth, solids=(), headroom=5, overrides=None):
    """Return a scene: water of ``depth`` cells in a box of ``cells`` (nx, ny) with solids in it."""
    top = max([depth + headroom, *(s["position"][2] / DX + 8 for s in solids)])
    scene = {
        "time": {"end": 10.0, "dt": 0.005},
        "domain": {"upper": [cells[0] * DX, cells[1] * DX, top * DX], "spacing": DX},
        "fluid": {"drag": 30.0, "fill": [{"lower": [0, 0, 0], "upper": [cells[0] * DX, cells[1] * DX, depth * DX]}]},
        "solid": list(solids),
        "solver": {},
    }
    for key, value in (overrides or {}).items():
        section, name = key.split(".")
        scene[section][name] = value
    return scene_from_dict(scene)


def release(sim):
    """Switch the settling drag off."""
    fluid = sim.do.params["fluid"]
    sim.do.params["fluid"] = fluid._replace(drag=type(fluid.drag)(0))
    sim.do.forget()


def column(cells, depth, settle, rest, overrides=None):
    """Return the V10 figures of a column that settled and was left alone, averaged over the last half of the rest."""
    sim = Simulation(tank(cells, depth, overrides=overrides), "cpu")
    found = []
    for k in range(settle + rest):
        if k == settle:
            release(sim)
        sim.step()
        if k >= settle + rest // 2 and k % 5 == 0:
            liquid = sim.read("phase") == 0
            z, p, v = sim.read("position")[liquid, 2], sim.read("pressure")[liquid], sim.read("velocity")[liquid]
            inside = (z > 3 * DX) & (z < (depth - 4) * DX)
            full = 1000 * G * depth * DX
            truth = 1000 * G * np.maximum(depth * DX - z, 0)
            found.append(
                (
                    -np.polyfit(z[inside], p[inside], 1)[0] / (1000 * G),
                    p[z < DX].mean() / (1000 * G * (depth - 0.5) * DX),
                    np.sqrt(np.mean((p - truth) ** 2)) / full,
                    np.sqrt((v**2).sum(axis=1).mean()),
                )
            )
    return np.mean(found, axis=0)


def cube(edge, cells, depth, density, steps, clearance, overrides=None, fixed=False):
    """Return the vertical force on a fixed cube over its displaced weight, or the draft fraction of a free one."""
    middle = [
        cells[0] * DX / 2 + (DX / 2 if (cells[0] - edge) % 2 else 0),
        cells[1] * DX / 2 + (DX / 2 if (cells[1] - edge) % 2 else 0),
    ]
    solid = {
        "name": "cube",
        "anchor": "base",
        "position": [*middle, clearance * DX],
        "size": [edge * DX] * 3,
        "density": density,
    }
    sim = Simulation(tank(cells, depth, [solid], overrides=overrides), "cpu")
    forces, drafts = [], []
    start = {n: sim.state.read(n) for n in ("position", "site")}
    home = np.zeros((3, sim.state.sizes["site"]), start["position"].dtype)
    is_solid = start["site"] >= 0
    home[:, start["site"][is_solid]] = start["position"][:, is_solid]
    for k in range(steps):
        if k == steps // 3:
            release(sim)
        sim.step()
        phase, force = sim.read("phase"), sim.read("force")
        if fixed:  # put it back: its lattice carries no load of its own
            x, v, site = sim.state.read("position"), sim.state.read("velocity"), sim.state.read("site")
            held = site >= 0
            x[:, held], v[:, held] = home[:, site[held]], 0
            sim.state.set("position", x)
            sim.state.set("velocity", v)
            weight = 1000 * G * edge**3 * DX**3
            own = float(sim.read("mass")[phase == 1].sum()) * G
            forces.append((float(force[phase == 1, 2].sum()) + own) / weight)
        else:
            z = sim.read("position")[phase == 1, 2]
            bottom, base, area = z.min() - DX / 2, (edge * DX) ** 2, cells[0] * cells[1] * DX**2
            level = ((phase == 0).sum() * DX**3 - base * bottom) / (area - base)
            drafts.append((level - bottom) / (edge * DX))
    series = forces if fixed else drafts
    return float(np.mean(series[2 * steps // 3 :])), float(np.std(series[2 * steps // 3 :])), sim


def extreme(density, steps):
    """Follow a cube of 6^3 that is let go over water 8 spacings deep.

    Returns the mean height of its lowest layer over the last 0.5 s and the least ever, rms of its centre's height about
    a straight line over the last 0.5 s, least height of a liquid particle (all in spacings), lost particles.
    """
    cells, depth, floats = (12, 12), 8, density < 1000
    solid = {"name": "cube", "anchor": "base", "position": [1.2, 1.2, (depth if floats else depth + 1) * DX],
             "size": [6 * DX] * 3, "density": density}
    sim = Simulation(tank(cells, depth, [solid]), "cpu")
    lowest, centre, wet = [], [], []
    for k in range(steps):
        if k == steps // 4:
            release(sim)
        sim.step()
        phase, z = sim.read("phase"), sim.read("position")[:, 2] / DX
        lowest.append(z[phase == 1].min())
        centre.append(z[phase == 1].mean())
        wet.append(z[phase == 0].min())
    late = np.array(centre[-100:])
    drift = np.polyval(np.polyfit(np.arange(late.size), late, 1), np.arange(late.size))
    return np.mean(lowest[-100:]), min(lowest), np.std(late - drift), min(wet), sim.series()["lost_particles"]


def run(out, quick=False, say=print):
    """Run all cases; ``quick`` takes narrow tanks and short rests."""
    side, settle, rest = ((6, 6), 60, 60) if quick else ((10, 10), 200, 400)
    with h5py.File(out, "w") as file:
        columns = {
            "default": {},
            "after 10 s": {},
            "beta = 0": {"solver.mirror": 0.0},
            "paper's fast mode": {"time.n_sub": 1, "fluid.sound_speed": "legal"},
        }
        for name, overrides in columns.items():
            values = column(side, 20, settle, rest * (5 if name == "after 10 s" else 1), overrides)
            file[f"V10/{name}"] = values
            say(
                f"V10 {name}: slope {values[0]:.4f}, bottom {values[1]:.3f}, rms {values[2]:.3f}, vrms {values[3]:.4f} m/s"
            )
        steps = 90 if quick else 300
        for scale in (0.77, 0.9, 1.0):
            ratio, spread, _ = cube(6, (12, 12), 14, 1000.0, steps, 4, {"solver.solid_scale": scale}, fixed=True)
            file[f"V12/6^3, scale {scale}"] = (ratio, spread)
            say(f"V12 6^3 cube, solid_scale {scale}: force ratio {ratio:.3f} +- {spread:.3f}")
            if not quick:
                draft, spread, _ = cube(6, (12, 12), 8, 500.0, 400, 6, {"solver.solid_scale": scale})
                file[f"V13/scale {scale}, ratio 0.5"] = (draft, spread)
                say(f"V13 ratio 0.5, solid_scale {scale}: draft {draft:.3f} +- {spread:.3f}")
        if not quick:
            ratio, spread, _ = cube(17, (25, 25), 25, 1000.0, 150, 4, fixed=True)
            file["V12/17^3, default"] = (ratio, spread)
            say(f"V12 17^3 cube, default: force ratio {ratio:.3f} +- {spread:.3f}")
        for density in (250.0, 500.0, 917.0):
            draft, spread, _ = cube(6, (12, 12), 8, density, 120 if quick else 500, 6)
            file[f"V13/{density:g}"] = (draft, spread)
            say(f"V13 density {density:g}: draft {draft:.3f} +- {spread:.3f}")
        for density in (10.0, 200.0, 300.0, 8000.0, 1e4, 1e5):
            values = extreme(density, 120 if quick else 500)
            file[f"V13 extremes/{density:g}"] = values
            say(
                f"V13 density {density:g}: lower face {values[0]:.2f} dx above the floor (least {values[1]:.2f}), "
                f"jitter {values[2]:.3f} dx, lowest liquid {values[3]:.2f} dx, {values[4]:.0f} lost"
            )
        file.attrs["quick"] = quick


def report(path):
    """Return the rows."""
    rows = []
    with h5py.File(path) as file:
        claimed = not file.attrs["quick"]
        limits = (
            ("slope / rho g", 0.01, 1),
            ("bottom layer / rho g h", 0.06, 1),
            ("rms / p_max", 0.04, 0),
            ("vrms at rest [m/s]", 0.001, 0),
        )
        for name in file["V10"]:
            for (what, bound, truth), value in zip(limits, file[f"V10/{name}"][()]):
                judged = claimed and name == "default"
                rows.append(
                    Row(
                        f"V10 {what}, {name}",
                        f"{truth}",
                        f"{value:.4f}",
                        f"+- {bound}" if judged else "",
                        bool(abs(value - truth) <= bound) if judged else None,
                    )
                )
        for name in file["V12"]:
            ratio, spread = file[f"V12/{name}"][()]
            default = "default" in name or "scale 1.0" in name
            bound = 0.03 if "17" in name else 0.05
            rows.append(
                Row(
                    f"V12 force on a fixed cube, {name}",
                    "1",
                    f"{ratio:.3f} +- {spread:.3f}",
                    f"+- {bound}" if default and claimed else "",
                    bool(abs(ratio - 1) <= bound) if default and claimed else None,
                )
            )
        for name in file["V13"]:
            draft, spread = file[f"V13/{name}"][()]
            truth = 0.5 if "scale" in name else float(name) / 1000
            judged = claimed and "scale" not in name
            rows.append(
                Row(
                    f"V13 draft fraction, {name}",
                    f"{truth:g}",
                    f"{draft:.3f} +- {spread:.3f}",
                    "+- 0.03" if judged else "",
                    bool(abs(draft - truth) <= 0.03) if judged else None,
                )
            )
        for name in sorted(file["V13 extremes"], key=float):
            face, least, jitter, wet, lost = file[f"V13 extremes/{name}"][()]
            density = float(name)
            # afloat with at most its own share under water; or under water, and nothing ever through the floor
            ok = face > 8 - 6 * density / 1000 - 0.5 if density < 1000 else face < 4 and least > 0
            ok = ok and wet > 0  # nor may liquid be pressed into the floor
            rows.append(
                Row(
                    f"V13 density {name}",
                    "floats" if density < 1000 else "sinks, stays above the floor",
                    f"lowest layer at {face:.2f} dx, least {least:.2f} dx",
                    "",
                    bool(ok and lost == 0) if claimed else None,
                    f"lowest liquid {wet:.2f} dx, {int(lost)} lost",
                )
            )
            if density == 10:
                rows.append(Row("V13 jitter at density 10 [dx rms]", "0", f"{jitter:.4f}", "<= 0.05" if claimed else "",
                                bool(jitter <= 0.05) if claimed else None))
    return rows
