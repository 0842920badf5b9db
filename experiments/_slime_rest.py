"""Water at rest in a tank: pressure against rho g depth, noise of the surface row, speed that is left."""

import numpy as np

from experiments._slime_runs import liquid, settings_of, start, to

G, RHO = 9.81, 1000.0


def tank(*settings, end=0.2, **taken):
    """Return errors of the pressure over rho g H, the scatter of the top row over rho g d0, and the speed over sqrt(g H).

    `L2` is of the pressure averaged over the second half of the run, `L2_each` the mean of its instants, `L2_last` the last one.
    """
    sim = start("hydrostatic", *settings, **taken)
    d = sim.scene.spacing
    q = liquid(sim)
    depth = q.x[:, 1].max() + d / 2
    kept, fastest, left = [], [], []

    def watch(sim):
        q = liquid(sim)
        fastest.append(float(np.sqrt((q.v**2).sum(axis=1).max())))
        left.append(float(np.sqrt((q.v**2).sum(axis=1).mean())))
        if sim.time > end / 2:
            kept.append((q.p - RHO * G * (depth - q.x[:, 1])) / (RHO * G * depth))

    found = to(sim, end, watch)
    off, q = np.array(kept), liquid(sim)
    top = q.x[:, 1] > depth - d * 0.9
    scale, speed = depth / d, np.sqrt(G * depth)
    return {
        "L2": float(np.sqrt((off.mean(axis=0) ** 2).mean())), "L2_each": float(np.sqrt((off**2).mean(axis=1)).mean()),
        "L2_last": float(np.sqrt((off[-1] ** 2).mean())), "surface_std": float(off[:, top].std(axis=1).mean() * scale),
        "speed": fastest[-1] / speed, "rms": left[-1] / speed, "largest": max(fastest) / speed,
        "speeds": np.array(fastest) / speed, "level": float(q.x[:, 1].max() + d / 2 - depth) / d,
        "seconds": found["seconds"], "settings": settings_of(sim, found),
    }
