"""Shape matching of a free, spinning cube (V16).

A cube of 4^3 particles turns once per second for two revolutions, without forces and damping, dt = 5 ms, w = 2: angular
momentum and centre stay, little energy is lost, and it hardly strains (largest change of a particle's distance from the
centre, relative). Only float64 is judged: in float32 goals are rounded, and (g - x)/dt amplifies that.
"""

import h5py
import numpy as np

from experiments import Row, claiming
from melt.scene import scene_from_dict
from melt.simulation import Simulation

DX = 0.2


def cube(precision, damping=0.0):
    """Return a simulation of the cube, turning about z."""
    sim = Simulation(scene_from_dict({
        "time": {"end": 2.0, "dt": 0.005, "n_sub": 1},
        "domain": {"upper": [4.0, 4.0, 4.0], "spacing": DX, "gravity": [0, 0, 0], "walls": {"sides": "none"}},
        "solid": [{"name": "cube", "lower": [1.6] * 3, "upper": [2.4] * 3}],
        "solver": {"precision": precision, "damping": damping, "width": 2},
    }), "cpu")
    x = sim.state.read("position")
    sim.state.set("velocity", 2 * np.pi * np.cross([0.0, 0.0, 1.0], (x - x.mean(axis=1, keepdims=True)).T).T)
    return sim


def moments(sim):
    """Return mass centre, angular momentum about it, kinetic energy, distances from the centre."""
    x, v, m = (sim.read(n).astype(float) for n in ("position", "velocity", "mass"))
    centre = m @ x / m.sum()
    L = (m[:, None] * np.cross(x - centre, v)).sum(axis=0)
    return centre, L, 0.5 * float(m @ (v**2).sum(axis=1)), np.linalg.norm(x - centre, axis=1)


def spin(precision, steps=400):
    """Return drift of L, of the centre [dx], energy lost, and the largest strain."""
    sim = cube(precision)
    centre, L, energy, apart = moments(sim)
    away = strain = 0.0
    for _ in range(steps):
        sim.step()
        now, L_now, energy_now, apart_now = moments(sim)
        away = max(away, np.abs(now - centre).max() / DX)
        strain = max(strain, np.abs(apart_now / apart - 1).max())
    return np.linalg.norm(L_now - L) / np.linalg.norm(L), away, 1 - energy_now / energy, strain


def run(out, quick=False, say=print):
    """Spin in double and single precision."""
    with h5py.File(out, "w") as file:
        file.attrs["quick"] = quick
        for precision in ("double", "single", "mixed"):
            file[precision] = spin(precision, 50 if quick else 400)
            say(f"V16 {precision}: dL/L {file[precision][0]:.1e}, centre {file[precision][1]:.1e} dx, "
                f"energy lost {file[precision][2]:.3%}, strain {file[precision][3]:.3%}")


def report(path):
    """Return the rows."""
    rows = []
    with h5py.File(path) as file:
        for precision in file:
            drift, away, lost, strain = file[precision][()]
            judged = precision == "double"
            for name, value, bound in (("angular momentum", drift, 1e-12), ("centre [dx]", away, 1e-12),
                                       ("energy lost", lost, 0.005), ("strain", strain, 0.003)):
                rows.append(Row(f"V16 {name}, {precision}", "0", f"{value:.1e}", f"<= {bound:g}" if judged else "",
                                bool(abs(value) <= bound) if judged else None))
        return claiming(rows, file.attrs.get("quick", False))
