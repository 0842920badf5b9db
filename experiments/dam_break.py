"""Dam break: the front of a collapsing column against three experiments (V11).

A column a x 2a, a = 20 spacings, between free-slip walls, dry bed. Z = front / a over T = t sqrt(2 g / a), against
Martin & Moyce 1952 (a = 1.125 and 2.25 in) and Koshizuka & Oka 1996. The gate of the experiments takes time to open:
the rule allows one common shift of T up to 0.25. Front: the foremost liquid particle that is not alone.
"""

import csv

import h5py
import numpy as np

from experiments import Row
from melt.scene import load_scene
from melt.scene.load import data_folder
from melt.simulation import Simulation

SETS = {
    "Martin & Moyce 1952, a = 1.125 in": "martin_moyce_1952_a1.125in.csv",
    "Martin & Moyce 1952, a = 2.25 in": "martin_moyce_1952_a2.25in.csv",
    "Koshizuka & Oka 1996": "koshizuka_oka_1996.csv",
}
A = 0.05715  # column width of the scene [m]


def measured(name):
    """Return (T, Z) of an experiment."""
    with open(data_folder() / "measured" / SETS[name]) as file:
        rows = [
            [float(v) for v in row] for row in csv.reader(line for line in file if line[0].isdigit() or line[0] == ".")
        ]
    return np.array(rows).T


def front(sim):
    """Return x / a of the foremost liquid particle with at least five neighbours."""
    count = sim.state.read("neighbour_count")[np.argsort(sim.state.read("id"), kind="stable")]
    x = sim.read("position")[(sim.read("phase") == 0) & (count >= 5), 0]
    return (float(x.max()) + 0.5 * sim.scene.spacing) / A


def run(out, quick=False, say=print):
    """Run the scene until the front reaches 5 a (``quick``: 2 a of the small scene)."""
    sim = Simulation(load_scene("dam_break_small" if quick else "dam_break"), "cpu")
    scale = np.sqrt(2 * 9.81 / A)
    T, Z = [0.0], [1.0]
    while Z[-1] < (2.0 if quick else 5.1) and sim.time * scale < 5:
        sim.step()
        T.append(sim.time * scale)
        Z.append(front(sim))
    say(f"dam break: Z = {Z[-1]:.2f} at T = {T[-1]:.2f}, {len(T)} steps, n_sub {sim.do.notes.get('n_sub')}")
    with h5py.File(out, "w") as file:
        file["T"], file["Z"] = T, Z
        file.attrs.update(
            quick=quick,
            particles=int((sim.read("phase") == 0).sum()),
            **{
                k: v
                for k, v in sim.series().items()
                if k in ("density_error_mean", "density_error_max", "lost_particles")
            },
        )


def fit(T, Z, t, z):
    """Return (mean |relative error| as it is, after the best common shift, that shift)."""

    def error(shift):
        return float(np.mean(np.abs(np.interp(t - shift, T, Z) / z - 1)))

    inside = z < max(Z)
    t, z = t[inside], z[inside]
    shifts = np.linspace(0, 0.25, 101)
    errors = [error(s) for s in shifts]
    return error(0.0), min(errors), float(shifts[int(np.argmin(errors))])


def report(path):
    """Return two rows per experiment."""
    rows = []
    with h5py.File(path) as file:
        T, Z, claimed = file["T"][()], file["Z"][()], not file.attrs["quick"]
        note = (
            f"{file.attrs['particles']:,} liquid particles, mean density error {file.attrs['density_error_mean']:.2%}"
        )
    for name in SETS:
        t, z = measured(name)
        raw, shifted, shift = fit(T, Z, t, z)
        judged = claimed and name.startswith("Martin")
        rows.append(
            Row(
                f"V11 front, {name}: mean relative error",
                "0",
                f"{raw:.1%}",
                "<= 12 %" if judged else "",
                bool(raw <= 0.12) if judged else None,
                note,
            )
        )
        rows.append(
            Row(
                f"V11 front, {name}: after one shift",
                "0",
                f"{shifted:.1%} at dT = {shift:.2f}",
                "<= 5 %, dT <= 0.25" if judged else "",
                bool(shifted <= 0.05) if judged else None,
            )
        )
    return rows
