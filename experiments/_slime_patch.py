"""Bodies of liquid that move freely: a rotating square, a stretching ellipse, a drop that swings in a central field."""

import math

import numpy as np
from scipy.spatial import cKDTree

from experiments._slime_runs import energy, liquid, settings_of, spin, start, to, turned
from melt.slime.exact import axes, axes_of

EARLY = (0.045, 0.125)  # w t over which it is averaged: the first steps also hold what the start's density lacks
CENTRE = 0.1473  # -p/(rho w^2 L^2) in the middle of a rotating square, from the series of Laplace's equation


def square(*settings, end=2.0, **taken):
    """Return the pressure in the middle at the start, and what a rotating square keeps until w t = ``end`` (w = L = 1)."""
    sim = start("rotating_square", *settings, **taken)
    middle, corners, least, q = [], [], [], liquid(sim)
    turn, moving, size = spin(q.m, q.x, q.v), energy(q.m, q.v), sim.scene.spacing

    def watch(sim):
        q = liquid(sim)
        if EARLY[0] < sim.time < EARLY[1]:
            r2 = (q.x**2).sum(axis=1)
            near = r2 < (3 * size) ** 2
            A = np.stack([np.ones(near.sum()), r2[near]], axis=1)
            middle.append(float(np.linalg.lstsq(A, q.p[near], rcond=None)[0][0] / 1000))
        reach = np.sqrt((q.x**2).sum(axis=1)).max() + size / math.sqrt(2)  # of a corner particle's own corner
        corners.append(reach / (math.sqrt(0.5) * math.sqrt(1 + sim.time**2)))
        least.append(q.p.min())

    found = to(sim, end, watch)
    q = liquid(sim)
    gap = cKDTree(q.x).query(q.x, 2)[0][:, 1]
    return {
        "centre": float(np.mean(middle)) if middle else math.nan, "spin": spin(q.m, q.x, q.v) / turn - 1, "corner": max(corners),
        "least": min(least) / 1000, "energy": energy(q.m, q.v) / moving - 1, "loneliest": float(gap.max() / size),
        "density": float(np.median(sim.read("density_ratio")[q.keep])), "seconds": found["seconds"], "settings": settings_of(sim, found),
    }


def ellipse(*settings, end=1.0, spacing=0.0795, **taken):
    """Return errors of the semi-axes and the energy of a disc that stretches without a force until A t = ``end``.

    Energy is compared with that after the first step.
    """
    sim = turned("oscillating_drop", "fluid.central=0", "fluid.flow.rate=1.0", f"domain.spacing={spacing}",
                "domain.lower=[-3.0, 0.0, -3.0]", "domain.upper=[3.0, 0.0, 3.0]", *settings, **taken)
    q = liquid(sim)
    first = axes(q.x, q.m)
    sim.step()
    q = liquid(sim)
    moving = energy(q.m, q.v)  # at t = 0 nodes at the rim have the mass of APIC particles further in, and their own speed
    found = to(sim, end)
    q = liquid(sim)
    _, a, b = axes_of(1.0, end)
    last = axes(q.x, q.m) / first
    return {"x": last[0] / a[-1] - 1, "z": last[1] / b[-1] - 1, "energy": energy(q.m, q.v) / moving - 1,
            "density": float(np.median(sim.read("density_ratio")[q.keep])), "seconds": found["seconds"],
            "settings": settings_of(sim, found)}


def drop(*settings, periods=1.5, **taken):
    """Return the period of a drop in a central field and its last amplitude over the exact ones."""
    sim = turned("oscillating_drop", *settings, **taken)
    rate, central = sim.scene.fluid.flow.rate, sim.scene.fluid.central
    t, a, _ = axes_of(rate, 12.0, central)
    period = _upward(t, a)[1] if len(_upward(t, a)) > 1 else math.nan
    times, wide, q = [0.0], [1.0], liquid(sim)
    first = axes(q.x, q.m)

    def watch(sim):
        last = axes(*_matter(sim)) / first
        times.append(sim.time)
        wide.append(float(last[0] / math.sqrt(last[0] * last[1])))  # of the area it has: a is 1 in the middle of a swing

    found = to(sim, 1.02 * periods * period, watch)
    times, wide = np.array(times), np.array(wide)
    exact = np.interp(times, t, a)
    up = _upward(times, wide)
    late = times > (periods - 1) * period
    swing = (wide[late].max() - wide[late].min()) / (exact[late].max() - exact[late].min())
    return {"period": (up[1] if len(up) > 1 else math.nan) / period - 1, "exact": period, "amplitude": swing - 1,
            "density": float(np.median(sim.read("density_ratio")[liquid(sim).keep])), "seconds": found["seconds"],
            "settings": settings_of(sim, found)}


def _matter(sim):
    q = liquid(sim)
    return q.x, q.m


def _upward(t, a):
    """Return 0 and the instants at which ``a`` passes 1 upwards."""
    k = np.flatnonzero((a[:-1] < 1) & (a[1:] >= 1))
    return [0.0, *(t[k] + (1 - a[k]) / (a[k + 1] - a[k]) * (t[k + 1] - t[k]))]
