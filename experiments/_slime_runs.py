"""Runs of incompressible and viscous liquids for validation: stepping, what the liquid's particles hold, tallies of solves."""

import time as clock
from types import SimpleNamespace

import numpy as np

from melt.geometry.build import build
from melt.physics.phases import LIQUID
from melt.scene import load_scene
from melt.simulation import Simulation
from melt.slime.build import flow

SOLVES = ("viscous", "poisson", "divergence", "density")


def start(scene, *settings, **taken):
    """Return the `Simulation` of a scene by name, with ``settings`` such as "domain.spacing=0.1"; ``taken``: see `without`."""
    return Simulation(without(load_scene(scene, list(settings)), **taken), "cpu")


def liquid(sim):
    """Return the liquid now, in its plane: x, v (n, 2) [x, z], m, p; of nodes, also where APIC particles carry the mass."""
    keep = sim.read("phase") == LIQUID
    plane = (0, 2)
    return SimpleNamespace(
        x=sim.read("position")[keep][:, plane].astype(float), v=sim.read("velocity")[keep][:, plane].astype(float),
        m=sim.read("mass")[keep].astype(float), p=sim.read("pressure")[keep].astype(float), keep=keep, time=sim.time,
    )


def to(sim, end, watch=None):
    """Advance to ``end`` [s], calling ``watch(sim)`` after each step; return wall seconds, sub-steps, mean iterations of each solve."""
    begun, steps, sub_steps, done = clock.perf_counter(), 0, 0, dict.fromkeys(SOLVES, 0)
    while sim.time < end - 1e-9 * max(end, 1.0):
        left = end - sim.time
        sim.step(left if left < sim.scene.time.dt * (1 - 1e-6) else None)
        notes = sim.do.notes
        steps, sub_steps = steps + 1, sub_steps + notes.get("n_sub", 1)
        for name in SOLVES:
            done[name] += notes.get(f"{name}_iterations", 0)
        if watch:
            watch(sim)
    means = {f"{name}_iterations": done[name] / max(sub_steps, 1) for name in SOLVES}
    return {"seconds": clock.perf_counter() - begun, "sub_steps": sub_steps, **means}


def settings_of(sim, found):
    """Return one line: particles, support, precision, dt, iterations per sub-step."""
    s = sim.scene
    worked = ", ".join(f"{name} {found[name + '_iterations']:.1f}" for name in SOLVES if found[f"{name}_iterations"])
    count = int((sim.read("phase") == LIQUID).sum())
    return (f"{count:,} particles, h = {s.solver.support:g} d0, {sim.prepared.precision}, {found['sub_steps']} sub-steps of "
            f"{sim.time / found['sub_steps']:.2g} s in the mean; iterations per sub-step: {worked}")


def energy(m, v):
    """Return the kinetic energy [J/m]."""
    return float(0.5 * (m * (v**2).sum(axis=1)).sum())


def spin(m, x, v):
    """Return the angular momentum about the centre of mass, positive from x to z [kg m/s]."""
    d = x - np.average(x, axis=0, weights=m)
    return float((m * (d[:, 0] * v[:, 1] - d[:, 1] * v[:, 0])).sum())


def without(scene, ghosts=True, nodes=False):
    """Return a scene without its air ghost particles (``ghosts`` false), without APIC particles (``nodes``): no setting does that."""
    left = {} if ghosts else {"ghosts": None}
    left |= {"apic": None} if nodes else {}
    return scene.model_copy(update={"solver": scene.solver.model_copy(update=left)})


def turned(scene, *settings, degrees=25.0, **taken):
    """Return the simulation of a disc with a flow whose lattice is turned: one stretched along its rows decouples (slime spec 4)."""
    scene = without(load_scene(scene, list(settings)), **taken)
    initial, c, s = build(scene), np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    for name in ("", "apic_"):
        if f"{name}position" in initial:
            x, v = initial[f"{name}position"], initial[f"{name}velocity"]
            x[0], x[2] = c * x[0] - s * x[2], s * x[0] + c * x[2]
            v[:] = flow(scene.fluid.flow, x)
    return Simulation(scene, "cpu", initial=initial)
