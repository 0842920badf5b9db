"""Ledgers of melting runs: momentum, mass, thermal energy, agreement of backends (V5, V14, V18, V20).

V14: a cube melts in a drop of hot liquid without gravity and walls, 1000 steps, mass kept (`melt_to = own`): the total
momentum stays zero. V20: the mass changes by nothing (own) or by exactly n_melted (rho_0 V_0 - m) (water). V5: the
thermal energy of a closed scene stays. V18: worst ratio of error to tolerance of a live run on CPU and emulated CUDA.
"""

import h5py
import numpy as np

from experiments import Row, claiming
from melt.scene import load_scene, scene_from_dict
from melt.simulation import Simulation


def drop(melt_to, precision, steps):
    """Return (change of |sum m v| / sum m |v|, mass drift, expected mass change, thermal drift, melted fraction).

    The first is NaN for melt_to = water.
    """
    scene = scene_from_dict(
        {
            "time": {"end": 10.0, "dt": 0.002},
            "domain": {"upper": [3.2, 3.2, 3.2], "spacing": 0.2, "gravity": [0, 0, 0], "walls": {"sides": "none"}},
            "fluid": {
                "temperature": 60.0,
                "reference_speed": 2.0,
                "fill": [{"shape": "sphere", "position": [1.6, 1.6, 1.6], "radius": 1.4}],
            },
            "solid": [
                {
                    "name": "ice",
                    "position": [1.7, 1.7, 1.7],
                    "size": [1.0, 1.0, 1.0],
                    "density": 917.0,
                    "liquid_density": 1000.0,
                    "temperature": -10.0,
                    "velocity": [0.5, 0.2, 0.0],
                }
            ],
            "heat": {},
            "solver": {"precision": precision, "melt_to": melt_to, "density_form": "volume"},
        }
    )
    sim = Simulation(scene, "cpu")
    first = sim.series()

    def momentum():
        m, v = sim.read("mass").astype(float), sim.read("velocity").astype(float)
        return (m[:, None] * v).sum(axis=0), float((m * np.sqrt((v**2).sum(axis=1))).sum())

    start, _ = momentum()
    for _ in range(steps):
        sim.step()
    end, total = momentum()
    last = sim.series()
    solids = int((sim.read("phase") == 1).sum())
    expected = (125 - solids) * (1000 - 917) * 0.2**3 if melt_to == "water" else 0.0
    drift = abs(last["thermal_energy"] / first["thermal_energy"] - 1)
    # melting into water makes mass, and with it momentum: nothing is claimed there
    momentum = float(np.abs(end - start).max() / total) if melt_to == "own" else np.nan
    return momentum, last["mass_created"], expected, drift, last["melted_fraction"]


def lockstep(steps):
    """Return {stage.field: worst ratio} of a live run on CPU and emulated CUDA."""
    sim = Simulation(
        load_scene("ice_cube_small", ["solid.0.position=[1.5, 1.3, 1.4]"]), "cpu", lockstep="cuda-emulated"
    )
    for _ in range(steps):
        sim.step()
    return {f"{stage}.{field}": found.ratio for (stage, field), found in sim.do.worst.items()}


def run(out, quick=False, say=print):
    """Run all ledgers."""
    steps = 100 if quick else 1000
    with h5py.File(out, "w") as file:
        for melt_to in ("own", "water"):
            for precision in ("single", "double"):
                values = drop(melt_to, precision, steps)
                file[f"drop/{melt_to}/{precision}"] = values
                say(
                    f"{melt_to}, {precision}: momentum {values[0]:.1e}, mass {values[1]:.6g} (expected {values[2]:.6g}) kg, "
                    f"thermal drift {values[3]:.1e}, melted {values[4]:.0%}"
                )
        worst = lockstep(2 if quick else 20)
        file["lockstep/name"], file["lockstep/ratio"] = list(worst), list(worst.values())
        file.attrs.update(steps=steps, quick=quick)


def report(path):
    """Return the rows."""
    rows = []
    with h5py.File(path) as file:
        for melt_to in file["drop"]:
            for precision in file[f"drop/{melt_to}"]:
                momentum, made, expected, drift, melted = file[f"drop/{melt_to}/{precision}"][()]
                note = f"{file.attrs['steps']} steps, {melted:.0%} melted"
                bound = 1e-12 if precision == "double" else 1e-5
                if melt_to == "own":
                    rows.append(
                        Row(
                            f"V14 momentum, own, {precision}",
                            "0",
                            f"{momentum:.1e} of sum m |v|",
                            f"<= {bound:g}",
                            bool(momentum <= bound),
                            note,
                        )
                    )
                whole = 1e4
                rows.append(
                    Row(
                        f"V20 mass, {melt_to}, {precision}",
                        f"{expected:.6g} kg",
                        f"{made:.6g} kg",
                        f"+- {bound:g} of the mass",
                        bool(abs(made - expected) <= bound * whole),
                        note,
                    )
                )
                judged = melt_to == "water"  # by the paper's law C = V, and V changes where the mass is kept
                rows.append(
                    Row(
                        f"V5 thermal energy of a melting run, {melt_to}, {precision}",
                        "0",
                        f"{drift:.1e}",
                        f"<= {bound:g}" if judged else "",
                        bool(drift <= bound) if judged else None,
                        note,
                    )
                )
        names, ratios = [n.decode() for n in file["lockstep/name"][()]], file["lockstep/ratio"][()]
        k = int(np.argmax(ratios))
        rows.append(
            Row(
                "V18 CPU and emulated CUDA in lockstep",
                "<= 1",
                f"{ratios[k]:.3g} of the tolerance",
                "<= 1",
                bool(ratios[k] <= 1),
                f"{len(names)} fields, worst {names[k]}; all stages: melt check",
            )
        )
        return claiming(rows, file.attrs.get("quick", False))
