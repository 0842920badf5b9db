"""A heap of viscous liquid spreads, and a viscoelastic liquid is sheared: cases of `experiments.slime_bodies`."""

import numpy as np

from experiments._slime_runs import start
from melt.scene import scene_from_dict
from melt.simulation import Simulation

MU, RHO, G = 200.0, 1000.0, 9.81
HALF = 0.25  # area of a half of the heap [m^2]


def heap(across, end=12.0):
    """A heap, 1 m wide and 0.5 m high, spreads to both sides; return exponent and factor of its front (Huppert 1982, in the plane).

    x_N = 1.411 (g q^3/(3 nu))^(1/5) t^(1/5), q the area of a half. Judged where the front is beyond 5 mean heights.
    """
    d = 0.5 / across
    scene = scene_from_dict({
        "scene": {"name": "heap"}, "time": {"end": end, "dt": 10e-3, "n_sub_max": 64},
        "domain": {"lower": [-3, 0, 0], "upper": [3, 0, 0.8], "spacing": d, "dimensions": 2, "walls": {"sides": ["z-"]}},
        "fluid": {"fill": [{"lower": [-0.5, -1, 0], "upper": [0.5, 1, 0.5]}], "density": RHO}, "viscosity": {"mu": MU},
        "solver": {"pressure": "hybrid", "ghosts": True, "precision": "double", "support": 2.4},
    })
    sim, times, front, height = Simulation(scene, "cpu"), [], [], []
    while sim.time < end - 1e-9:
        sim.step()
        x = sim.read("position")[sim.read("phase") == 0].astype(float)
        times.append(sim.time)
        front.append((np.ptp(x[:, 0]) + d) / 2)
        height.append(2 * x[:, 2].mean())
    t, x_N = np.array(times), np.array(front)
    far = x_N * x_N > 5 * HALF  # the mean height is HALF/x_N
    if far.sum() < 10:
        return {"exponent": np.nan, "factor": np.nan, "front": float(x_N[-1]), "n": len(x)}
    exponent = np.polyfit(np.log(t[far]), np.log(x_N[far]), 1)[0]
    scale = (G * HALF**3 * RHO / (3 * MU) * t[far]) ** 0.2
    return {"exponent": float(exponent), "factor": float((x_N[far] / scale)[-1] / 1.411), "front": float(x_N[-1]),
            "height": float(height[-1] / (HALF / x_N[-1])), "n": len(x)}


def sheared(end=1.5, relaxation=0.5, rate=2.0, modulus=1.0):
    """Oldroyd-B between plates of the scene couette; return shear stress and N1 over the exact ones at ``end``.

    tau = G l r (1 - exp(-t/l)), N1 = 2 G l^2 r^2 [1 - (1 + t/l) exp(-t/l)] of the polymer, in the middle half of the gap.
    """
    sim = start(
        "couette", "solver.apic={}", f"elastic={{modulus={modulus}, relaxation={relaxation}}}", f"time.end={end}",
        f"obstacle.1.velocity=[{rate * 0.01}, 0, 0]",
    )
    while sim.time < end - 1e-9:
        sim.step()
    there = sim.state.read("apic_phase") == 0
    x, b = (sim.state.read(name)[:, there].astype(float) for name in ("apic_position", "apic_strain"))
    C = sim.state.read("apic_affine")[2, there].astype(float)
    middle = np.abs(x[2] - 0.005) < 0.0025
    strain, s = relaxation * rate, end / relaxation
    tau, n1 = modulus * b[4, middle].mean(), modulus * (b[0] - b[2])[middle].mean()
    exact = (modulus * strain * (1 - np.exp(-s)), 2 * modulus * strain**2 * (1 - (1 + s) * np.exp(-s)))
    return {"tau": float(tau / exact[0]), "N1": float(n1 / exact[1]), "rate": float(C[middle].mean() / rate), "n": int(there.sum())}


def dropped(viscoelastic, across=20):
    """A drop, 2 cm wide, hits a plate at 1 m/s (4 Pa s, a tenth of it the solvent's, l = 0.02 s); return its widths.

    Newtonian (``viscoelastic`` false) it spreads ever on; of Oldroyd-B it springs back before it spreads on.

    Returns:
        widths over the diameter: ``widest``, the first that is not passed again for 0.02 s, ``least`` after it and ``last``;
        ``back`` = (widest - least)/widest.
    """
    D, V, mu, share, relaxation, end = 0.02, 1.0, 4.0, 0.1, 0.02, 0.12
    d = D / across
    facts = {
        "scene": {"name": "dropped"}, "time": {"end": end, "dt": 2e-4, "n_sub_max": 64},
        "domain": {"lower": [-0.05, 0, 0], "upper": [0.05, 0, 0.04], "spacing": d, "dimensions": 2, "walls": {"sides": ["z-"]}},
        "fluid": {"fill": [{"shape": "sphere", "position": [0, 0, D / 2], "radius": D / 2, "velocity": [0, 0, -V]}], "density": RHO},
        "viscosity": {"mu": share * mu if viscoelastic else mu},
        "solver": {"pressure": "hybrid", "apic": {}, "ghosts": {}, "precision": "double"},
    }
    if viscoelastic:
        facts["elastic"] = {"modulus": (1 - share) * mu / relaxation, "relaxation": relaxation}
    sim, times, width = Simulation(scene_from_dict(facts), "cpu"), [], []
    while sim.time < end - 1e-9:
        sim.step()
        x = sim.read("position")[sim.read("phase") == 0]
        times.append(sim.time)
        width.append((np.ptp(x[:, 0]) + d) / D)
    t, w = np.array(times), np.array(width)
    ahead = np.array([w[k] > w[(t > t[k]) & (t < t[k] + 0.02)].max(initial=0.0) for k in range(len(t))])
    peak = int(np.argmax(ahead & (t < end - 0.02)))
    if not ahead[peak]:
        peak = len(w) - 1
    return {"widest": float(w[peak]), "when": float(t[peak]), "least": float(w[peak:].min()), "last": float(w[-1]),
            "back": float(1 - w[peak:].min() / w[peak]), "shrinks": float(max(-np.diff(w).min(), 0.0)), "n": len(x)}
