"""Column of liquid at rest under the position based fluid (V6, V7)."""

import numpy as np

from melt.position_based import bottom_compression
from melt.scene import scene_from_dict
from melt.simulation import Simulation

D, G = 0.02, 9.81
LAW = {"one-sided, k_s 0": {"one_sided": True, "push": 0.0}, "default": {}}
#: V7: name -> (width in spacings, numbers of the solver, support)
RESTS = {
    "default": (10, {}, 2.2),
    "effect precision": (10, {"precision": True}, 2.2),
    "one-sided, k_s 0, c 0.01": (10, {"one_sided": True, "push": 0.0, "xsph": 2.4}, 2.2),
    "k_s 0.1": (10, {"push": 0.1}, 2.2),
    "6 wide": (6, {}, 2.2),
    "6 wide, k_s 0.1": (6, {"push": 0.1}, 2.2),
    "16 wide": (16, {}, 2.2),
    "effect precision by height alone": (10, {"precision": True, "height_share": 1.0}, 2.2),
    "effect precision, iterations alone": (10, {"precision": True, "minimum_support": 2.2}, 2.2),
    "effect precision, support alone": (10, {"precision": True, "minimum_iterations": 4}, 2.2),
    "support 1.8 d for all": (10, {}, 1.8),
}


def column(layers=20, width=10, dt=1 / 240, pbf=None, precision="double", support=2.2, **sections):
    """Return a scene: liquid of ``layers`` x ``width`` x ``width`` spacings between walls, one sub-step per step."""
    size = [width * D, width * D]
    return scene_from_dict({
        "time": {"end": 10.0, "dt": dt, "n_sub": 1},
        "domain": {"upper": [*size, 1.5 * layers * D], "spacing": D, **sections.pop("domain", {})},
        "fluid": {"fill": [{"lower": [0, 0, 0], "upper": [*size, layers * D]}], **sections.pop("fluid", {})},
        "solver": {"pressure": "pbf", "precision": precision, "support": support, "pbf": dict(pbf or {})},
        **sections,
    })


def rest(scene, layers, seconds):
    """Leave a column alone; return the figures of V6 and V7, means over the last third.

    C: of the lowest 3 spacings; speed: r.m.s. over g dt; height: mean over that of the lattice; drift of it [1/s];
    outside: particles beyond the walls at the end; law: the C predicted.
    """
    sim, dt = Simulation(scene, "cpu"), scene.time.dt
    steps = max(9, round(seconds / dt))
    every, found, side = max(1, steps // 120), [], np.array(scene.domain.upper[:2])
    for k in range(steps):
        sim.step()
        if k % every == 0:
            liquid = sim.state.read("phase") == 0
            x, v = sim.state.read("position")[:, liquid], sim.state.read("velocity")[:, liquid].astype(float)
            C = sim.state.read("constraint")[liquid].astype(float)
            low = C[x[2] < 3 * D].mean()
            speed = np.sqrt((v**2).sum(axis=0).mean()) / (G * dt)
            found.append((low, speed, x[2].mean() / (layers * D / 2), C.max(), (k + 1) * dt))
    late = np.array(found[2 * len(found) // 3 :])
    low, speed, height, most, _ = late.mean(axis=0)
    out = (x[2] < 0) | (x[:2] < 0).any(axis=0) | (x[:2] > side[:, None]).any(axis=0)
    return {
        "C": low, "speed": speed, "height": height, "most": late[:, 3].max(), "outside": int(out.sum()),
        "drift": float(np.polyfit(late[:, 4], late[:, 2], 1)[0]) if len(late) > 2 else 0.0,
        "law": bottom_compression(scene, layers, dt), "liquid": int(liquid.sum()), "steps": steps,
        "neighbours": float(sim.series()["neighbours_mean"]), "iterations": scene.solver.pbf.iterations,
    }
