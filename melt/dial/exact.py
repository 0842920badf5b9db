"""Errors of scenes whose solution is known: ``[scene] exact`` names one of `EXACT`. All are shares of the solution's own size.

The numbers of the solution (height, viscosity, drive) are those of the scene, so scenes of one's own can name one too.
"""

from typing import NamedTuple

import numpy as np

from melt.flood.dam_breaks import ritter, stoker
from melt.flood.pools import flow_of
from melt.slime.exact import axes, axes_of, couette, poiseuille

SWING = 20.0  # 1/rate up to which the ellipse is known


class Exact(NamedTuple):
    """What the error is in words, how it is found, and of which scenes the solution is."""

    words: str
    errors: callable  # simulation -> {name: share}
    of: str  # kind of scene, in words
    fits: callable  # scene -> whether it is of that kind


def _plane(sim):
    """Return x, v (n, 2) along x and z, and m of the liquid."""
    liquid = sim.read("phase") == 0
    x, v = (sim.read(name)[liquid][:, (0, 2)].astype(float) for name in ("position", "velocity"))
    return x, v, sim.read("mass")[liquid].astype(float)


def _l2(found, wanted):
    return float(np.sqrt(((found - wanted) ** 2).sum() / max((wanted**2).sum(), 1e-300)))


def _between_plates(solution, drive):
    def errors(sim):
        scene, (x, v, _) = sim.scene, _plane(sim)
        pool = scene.fluid.fill[0]
        H, nu = pool.upper[2] - pool.lower[2], scene.viscosity.mu / scene.fluid.density
        return {"velocity": _l2(v[:, 0], solution(x[:, 1] - pool.lower[2], sim.time, H, nu, drive(scene)))}

    return errors


def plate_speed(scene):
    """Return the speed of the plate that moves [m/s]."""
    return next((o.velocity[0] for o in scene.obstacle if o.driven), 0.0)


def _vortices(sim):
    """Return the error of the amplitude of the flow that was given: it decays as exp(-2 k^2 nu t)."""
    scene, (x, v, m) = sim.scene, _plane(sim)
    k = 2 * np.pi / scene.fluid.flow.length
    flow = np.stack([np.cos(k * x[:, 0]) * np.sin(k * x[:, 1]), -np.sin(k * x[:, 0]) * np.cos(k * x[:, 1])], axis=1)
    share = float((m[:, None] * v * flow).sum() / (m[:, None] * flow**2).sum())
    first = scene.fluid.flow.rate / k
    nu = scene.viscosity.mu / scene.fluid.density
    return {"amplitude": float(abs(abs(share) / first - np.exp(-2 * k**2 * nu * sim.time)))}


def _hydrostatic(sim):
    scene, (x, v, _) = sim.scene, _plane(sim)
    p = sim.read("pressure")[sim.read("phase") == 0].astype(float)
    H, g = scene.fluid.fill[0].upper[2] - scene.fluid.fill[0].lower[2], -scene.domain.gravity[2]
    unit = scene.fluid.density * g * H
    wanted = scene.fluid.density * g * (scene.fluid.fill[0].upper[2] - x[:, 1])
    return {"pressure": float(np.sqrt(((p - wanted) ** 2).mean())) / unit, "speed": float(np.sqrt((v**2).sum(axis=1).mean() / (g * H)))}


def _rotation(sim):
    """Return what a free patch has lost of its energy and angular momentum: nothing acts on it."""
    x, v, m = _plane(sim)
    m0 = sim.initial["mass"][sim.initial["phase"] == 0]
    x0 = sim.initial["position"][(0, 2), :][:, sim.initial["phase"] == 0]
    x0 = x0 - np.average(x0, axis=1, weights=m0)[:, None]
    rate = sim.scene.fluid.flow.rate
    d, v = (a - np.average(a, axis=0, weights=m) for a in (x, v))  # about its own centre, wherever that is and goes
    turn = abs(float((m * (d[:, 0] * v[:, 1] - d[:, 1] * v[:, 0])).sum()))
    inertia = float((m0 * (x0**2).sum(axis=0)).sum())
    return {"spin": abs(turn / (rate * inertia) - 1), "energy": abs(float((m * (v**2).sum(axis=1)).sum()) / (rate**2 * inertia) - 1)}


def _ellipse(sim):
    """Return the error of the semi-axis along x, in units of that at the start."""
    x, _, m = _plane(sim)
    liquid = sim.initial["phase"] == 0
    first = axes(sim.initial["position"][:, liquid].T[:, (0, 2)], sim.initial["mass"][liquid])
    flow = sim.scene.fluid.flow
    t, a, _ = axes_of(flow.rate, SWING / flow.rate, sim.scene.fluid.central)
    return {"axis": abs(axes(x, m)[0] / first[0] - float(np.interp(sim.time, t, a)))}


def _columns(sim):
    """Return x, y (local) [m], depth, volume, velocity of the water."""
    wet = sim.read("phase") == 0
    x = sim.read("position")[wet].astype(float)
    rest = (sim.read(name)[wet].astype(float) for name in ("depth", "rest_volume", "velocity"))
    return x[:, 0], x[:, 1], *rest


def _l1(d, exact, V):
    """Return the mean error of the depth over the mean depth, weighted with the area V/d of columns."""
    area = V / np.maximum(d, 1e-9)
    return float((area * np.abs(d - exact)).sum() / max((area * exact).sum(), 1e-300))


def _dam(sim):
    x, y, d, V, _ = _columns(sim)
    left, *right = sim.scene.fluid.fill
    X = sim.initial.terrain.world(np.stack([x, y]))[0] - left.upper[0]
    g = sim.scene.gravity
    exact = stoker(X, sim.time, left.depth, right[0].depth, g) if right else ritter(X, sim.time, left.depth, g)
    return {"depth": _l1(d, exact.depth, V)}


def _pool(sim):
    x, y, d, V, _ = _columns(sim)
    scene = sim.scene
    solution = flow_of(scene.fluid.fill[0], sim.initial.terrain, scene.gravity, scene.terrain.sampler, "pool", sim.time)
    return {"depth": _l1(d, solution(x, y)[0], V)}


def _rest(sim):
    x, y, d, V, v = _columns(sim)
    scene = sim.scene
    exact = flow_of(scene.fluid.fill[0], sim.initial.terrain, scene.gravity, scene.terrain.sampler, "pool")(x, y)[0]
    speed = float(np.sqrt((V * (v[:, :2] ** 2).sum(axis=1)).sum() / V.sum() / (scene.gravity * exact.max())))
    return {"depth": _l1(d, exact, V), "speed": speed}


def _liquid(scene, viscous=False):
    """Return whether a scene is a box of liquid with a pressure, given by its corners."""
    if scene.system not in ("melting", "slime") or not scene.solver.motion or not scene.fluid.fill:
        return False
    return scene.fluid.fill[0].upper is not None and (not viscous or scene.viscosity is not None)


def _flow(scene, kind):
    return scene.system == "slime" and scene.fluid.flow is not None and scene.fluid.flow.kind == kind


def _pools(scene, most):
    return scene.system == "flood" and 1 <= len(scene.fluid.fill) <= most


EXACT = {
    "couette": Exact(
        "L2 error of the velocity against the Fourier series, mean over the run", _between_plates(couette, plate_speed),
        "viscous liquid in a box ([viscosity]) under an [[obstacle]] that moves",
        lambda scene: _liquid(scene, viscous=True) and any(o.moves for o in scene.obstacle),
    ),
    "poiseuille": Exact(
        "L2 error of the velocity against the Fourier series, mean over the run",
        _between_plates(poiseuille, lambda scene: scene.domain.gravity[0]),
        "viscous liquid in a box ([viscosity]) with gravity along x",
        lambda scene: _liquid(scene, viscous=True) and scene.domain.gravity[0] != 0,
    ),
    "vortices": Exact(
        "error of the amplitude of the decaying vortices over that at the start, mean over the run", _vortices,
        "viscous liquid ([viscosity]) with [fluid.flow] kind = taylor_green",
        lambda scene: _flow(scene, "taylor_green") and scene.viscosity is not None,
    ),
    "hydrostatic": Exact(
        "r.m.s. error of the pressure over rho g H, or r.m.s. speed over sqrt(g H) if worse, mean over the run", _hydrostatic,
        "liquid in a box with gravity down, and a pressure (not a position based one)",
        lambda scene: _liquid(scene) and scene.domain.gravity[2] < 0,
    ),
    "rotation": Exact(
        "loss of energy or of angular momentum, which are conserved, the worse, mean over the run", _rotation,
        "liquid with [fluid.flow] kind = rotation", lambda scene: _flow(scene, "rotation"),
    ),
    "ellipse": Exact(
        "error of the semi-axis along x over that at the start, mean over the run", _ellipse,
        "liquid with [fluid.flow] kind = stretch and fluid.central", lambda scene: _flow(scene, "stretch") and scene.fluid.central > 0,
    ),
    "dam": Exact(
        "L1 error of the depth against Ritter's or Stoker's solution, mean over the run", _dam,
        "a flood with one or two boxes of water of a depth in [[fluid.fill]], the deep one first",
        lambda scene: _pools(scene, 2) and all(pool.depth and pool.upper for pool in scene.fluid.fill),
    ),
    "pool": Exact(
        "L1 error of the depth against Thacker's solution, mean over the run", _pool,
        "a flood with one [[fluid.fill]] whose profile knows its time (thacker_...)",
        lambda scene: _pools(scene, 1) and (scene.fluid.fill[0].profile or "").startswith("thacker"),
    ),
    "rest": Exact(
        "L1 error of the depth, or r.m.s. speed over sqrt(g d) if worse, of water that should rest, mean over the run", _rest,
        "a flood with one [[fluid.fill]]", lambda scene: _pools(scene, 1),
    ),
}
