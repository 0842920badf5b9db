"""What counts as stable: alarms, each a figure of the run against two limits."""

import math
from typing import NamedTuple

import numpy as np

from melt.watch.alarms import fastest

STABLE, NOISY, FAILED, REFUSED = "stable", "noisy", "failed", "refused"
GRADES = (STABLE, NOISY, FAILED, REFUSED)


class Fall(NamedTuple):
    """What a run is measured by: the fall through the height of what moves, and what drives it beside gravity, moving bodies too."""

    length: float  # height along gravity, else the largest extent [m]
    speed: float  # [m/s]
    time: float  # [s]
    mass: float  # [kg]
    start: dict  # series at the start

    @property
    def energy(self):
        """Energy that speeds are judged by [J]: of water at rest its potential energy above its floor."""
        return 0.25 * self.mass * self.speed**2


class Alarm(NamedTuple):
    """A figure of the run: above ``noisy`` the run is noisy, above ``failed`` it has failed."""

    words: str
    value: callable  # (simulation, series, fall) -> float
    noisy: float
    failed: float = math.inf


def fall_of(sim):
    """Return the `Fall` of a simulation at its start."""
    start, phase = sim.series(), sim.read("phase")
    moving = (phase == 0) | (phase == 1)
    x, m = sim.read("position")[moving].astype(float), sim.read("mass")[moving].astype(float)
    flood = sim.scene.kind == "flood"
    gravity = np.array([0.0, 0.0, sim.scene.gravity] if flood else sim.scene.domain.gravity)
    g, dx = float(np.linalg.norm(gravity)), sim.scene.spacing
    extent = np.ptp(x, axis=0) + dx if len(x) else np.full(3, dx)
    height = float(extent @ np.abs(gravity) / g) if g > 0 else float(extent.max())
    if flood:
        height = float(np.ptp(sim.read("bed")[moving]) + sim.read("depth")[moving].max())
    else:
        height = max(height, float(np.ptp(x[:, 2]) + dx)) if len(x) else dx
    speed2 = 2 * g * height + sim.initial.top_speed**2
    if sim.prepared.need.incompressible:
        s, rho = sim.prepared.settings, sim.scene.fluid.density
        speed2 += 2 * s.sigma / (rho * height) + (sim.scene.fluid.central**0.5 * height) ** 2
    driven = [fastest(body, height) for body in getattr(sim.prepared.settings, "bodies", ())]
    speed = max(math.sqrt(speed2), *(nozzle.speed for nozzle in sim.initial.nozzles), *driven, 1e-9)
    return Fall(height, speed, 2 * height / speed, float(m.sum()) or 1.0, start)


def energy_gained(sim, series, fall):
    """Energy above that at the start over the energy scale; 0 where something brings energy."""
    scene = sim.scene
    if scene.inflow or getattr(scene, "edge", None) or any(getattr(o, "driven", False) for o in scene.obstacle):
        return 0.0
    gained = sum(series[name] - fall.start[name] for name in ("kinetic_energy", "potential_energy"))
    return gained / fall.energy


def speed(sim, series, fall):
    """Largest speed over that of a fall through the height of the liquid."""
    return sim.do.clock.max_speed / fall.speed


def sideways(sim, series, fall):
    """Root mean square of horizontal speeds of the liquid over that of a fall through its height."""
    v = sim.read("velocity")[sim.read("phase") == 0, :2].astype(float)
    return float(np.sqrt((v**2).sum(axis=1).mean())) / fall.speed


def compression(sim, series, fall):
    """Mean compression of the liquid."""
    return series.get("density_error_mean", 0.0)


def overshoot(sim, series, fall):
    """Temperature beyond the range that it started in (heaters included), over that range."""
    lowest, highest = temperatures(sim)
    T = sim.read("temperature")[sim.read("phase") <= 1].astype(float)
    return float(max(T.max() - highest, lowest - T.min()) / max(highest - lowest, 1e-9))


def temperatures(sim):
    """Return the lowest and highest temperature [degC] that the start and a heater allow."""
    T = sim.initial["temperature"][sim.initial["phase"] <= 1]
    heater = sim.scene.boiling.heater if sim.scene.boiling is not None else None
    heated = [] if heater is None else [heater.temperature]
    return float(min(T.min(), *heated, T.max())), float(max(T.max(), *heated, T.min()))


ENERGY = Alarm("energy gained", energy_gained, 0.01, 10.0)
SPEED = Alarm("speed", speed, 2.0, 20.0)
COMPRESSION = Alarm("compression", compression, 0.05, 1.0)
SIDEWAYS = Alarm("sideways speed of water at rest", sideways, 0.01, 1.0)
OVERSHOOT = Alarm("temperature out of its range", overshoot, 1e-3, 1.0)
