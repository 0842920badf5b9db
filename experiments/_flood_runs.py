"""Runs of floods for validation: stepping, what the columns hold in world coordinates, depth on a grid.

Columns are read at one instant: places at t^n, velocities a mean half sub-step earlier (leap-frog).
"""

import time as clock
from types import SimpleNamespace

import numpy as np

from melt.geometry.depth_sums import near, weight
from melt.physics.phases import LIQUID
from melt.scene import load_scene
from melt.simulation import Simulation


def start(scene, *settings, precision=None, preset=None):
    """Return the `Simulation` of a scene by name, with ``settings`` such as "fluid.spacing=0.1" or {"section": {...}}."""
    return Simulation(load_scene(scene, list(settings), preset), "cpu", precision)


def columns(sim):
    """Return the liquid columns now: x, y (world) [m], u, v, depth, bed (world), V, A = V/d, h, phase left out."""
    keep = sim.read("phase") == LIQUID
    x, velocity = sim.read("position")[keep].astype(float), sim.read("velocity")[keep].astype(float)
    x, y = sim.initial.terrain.world(x[:, :2].T)
    wide = {name: sim.read(name)[keep].astype(float) for name in ("depth", "bed", "rest_volume", "support_radius")}
    return SimpleNamespace(
        x=x, y=y, u=velocity[:, 0], v=velocity[:, 1], depth=wide["depth"], bed=wide["bed"] + sim.initial.terrain.datum,
        V=wide["rest_volume"], A=wide["rest_volume"] / np.maximum(wide["depth"], 1e-12), h=wide["support_radius"],
        time=sim.time, kernel=sim.scene.solver.kernel, bounds=sim.initial.terrain.bounds,
    )


def to(sim, end, watch=None):
    """Advance to ``end`` [s]; ``watch(sim)`` is called after each outer step. Return seconds, column steps, sub-steps."""
    begun, sub_steps = clock.perf_counter(), sim.do.clock.sub_step
    while sim.time < end - 1e-9:
        sim.step(min(sim.scene.time.dt, end - sim.time) if end - sim.time < sim.scene.time.dt - 1e-9 else None)
        if watch:
            watch(sim)
    sub_steps = sim.do.clock.sub_step - sub_steps
    return SimpleNamespace(seconds=clock.perf_counter() - begun, sub_steps=sub_steps, column_steps=sub_steps * sim.do.clock.active)


def scatter(c, x, y, sides=()):
    """Return depth, and volume flux (2, n), at points by sum_j V_j W(r, h_j); ``sides`` mirror (x or y, place).

    Conservative: W has the integral 1. The solver's normalisation corrects sums at the columns themselves, where W peaks;
    elsewhere it would take half a per cent too much.
    """
    X, V, u, h = np.stack([c.x, c.y]), c.V, np.stack([c.u, c.v]), c.h
    for axis, at in sides:
        close = np.abs(X[axis] - at) < h
        image, turned = X[:, close].copy(), u[:, close].copy()
        image[axis], turned[axis] = 2 * at - image[axis], -turned[axis]
        X, V, u, h = np.hstack([X, image]), np.concatenate([V, V[close]]), np.hstack([u, turned]), np.concatenate([h, h[close]])
    points = np.stack([np.ravel(x), np.ravel(y)])
    pairs = near(X, points, h)
    share = V[pairs.row] * _W(pairs.r, h[pairs.row], c.kernel)
    n = points.shape[1]
    depth = np.bincount(pairs.other, share, n)
    flux = np.stack([np.bincount(pairs.other, share * component[pairs.row], n) for component in u])
    return depth.reshape(np.shape(x)), flux.reshape(2, *np.shape(x))


def _W(r, h, kernel):
    """Return W(r) of support radius h [1/m^2]."""
    if kernel == "cubic":
        return weight(r, h)
    q = np.minimum(r / h, 1.0)
    return 7 / (np.pi * h**2) * (1 - q) ** 4 * (1 + 4 * q)
