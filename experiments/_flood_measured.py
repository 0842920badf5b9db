"""Runs of the measured floods: scenes of `data/scenes`, what their gauges read, how high the water came.

A case is a function of (quick) that returns a `Case`: what `experiments.flood_measured` writes, and nothing judged.
"""

import time as clock
from dataclasses import dataclass, field

import numpy as np

from experiments import _flood_data as data
from experiments import _flood_norms as norms
from melt.physics.phases import LIQUID
from melt.scene import load_scene
from melt.simulation import Simulation

THIN = 2e-3  # columns thinner than this [m] do not count for run-up


@dataclass
class Case:
    """facts: numbers about the run; gauges, measured: name -> (t, y); curves: name -> array."""

    facts: dict
    gauges: dict
    measured: dict
    curves: dict = field(default_factory=dict)


def ran(scene, settings=(), preset=None, watch=None):
    """Run a scene to its end; return (simulation, facts, readings). ``watch(sim)`` is called after each outer step."""
    sim = Simulation(load_scene(scene, settings, preset), "cpu")
    begun = clock.perf_counter()
    while sim.time < sim.scene.time.end - 1e-9:
        sim.step()
        if watch:
            watch(sim)
    ledger = sim.series()
    facts = {
        "columns": sim.initial.active,
        "columns_end": ledger["liquid_particles"],
        "spacing": sim.scene.spacing,
        "steps": sim.do.clock.sub_step,
        "seconds": clock.perf_counter() - begun,
        "volume_error": ledger["volume_error"],
        "precision": sim.prepared.precision,
        "end": sim.time,
    }
    return sim, facts, sim.readings()


def _read(sim, readings, what, shift=0.0, delay=0.0):
    """Return name -> (t, y) of all gauges of a scene."""
    t = readings["time"] + delay
    return {g.name: (t, readings[what][:, k] - shift) for k, g in enumerate(sim.scene.gauge)}


class Shore:
    """How high the water comes: highest bed under a column that is thick enough; of all, by direction, near places."""

    def __init__(self, thinnest, centre=None, places=(), reach=0.15):
        self.thinnest, self.centre, self.places, self.reach = thinnest, centre, np.asarray(places), reach
        self.near = np.full(len(places), -np.inf)
        self.top, self.series, self.around = -np.inf, [], np.full(16, -np.inf)

    def __call__(self, sim):
        terrain = sim.initial.terrain
        keep = (sim.read("phase") == LIQUID) & (sim.read("depth") > self.thinnest)
        bed = sim.read("bed")[keep].astype(float) + terrain.datum
        self.series.append((sim.time, bed.max(initial=-np.inf)))
        self.top = max(self.top, self.series[-1][1])
        if self.centre is None and not len(self.places):
            return
        x = terrain.world(sim.read("position")[keep][:, :2].T)
        for k, place in enumerate(self.places):
            close = np.hypot(*(x - place[:, None])) < self.reach
            self.near[k] = max(self.near[k], bed[close].max(initial=-np.inf))
        if self.centre is None:
            return
        x = x - np.array(self.centre)[:, None]
        near = np.hypot(*x) < 3.6
        sector = np.round(np.degrees(np.arctan2(x[1], x[0]))[near] / 22.5).astype(int) % 16
        np.maximum.at(self.around, sector, bed[near])


def sill(quick=False):
    """Dam break over a triangular sill: depths at four gauges."""
    case = data.triangular_sill() or data.shipped_sill()
    sim, facts, readings = ran("triangular_sill", ["fluid.spacing=0.15", "time.end=6"] if quick else [])
    return Case(facts, _read(sim, readings, "depth"), case.gauges)


COARSE_BEACH = ["fluid.spacing=0.2", "terrain.upper=[62.0, 0.8]", "terrain.cell=0.2", "gauge=[]"]


def beach(preset, quick=False):
    """Solitary wave on a beach; lengths in still depths (1 m in the scene), times in sqrt(d/g)."""
    case = data.solitary_beach()
    if case is None:
        return None
    shore = Shore(THIN)
    settings = COARSE_BEACH if quick else []
    sim, facts, _ = ran("solitary_beach", settings, preset, shore)
    H = sim.scene.fluid.fill[0].parameters["height"]
    facts |= {"H": H, "runup": shore.top, "start": shore.series[0][1]}
    close = np.abs(case.runup[:, 0] / H - 1) < 0.15
    facts |= {"measured": float(np.mean(case.runup[close, 1])), "runs": int(close.sum())}
    return Case(facts, {}, {}, {"shore": np.array(shore.series)})


def monai(quick=False):
    """Monai valley: surface at three gauges, run-up at three places."""
    case = data.monai()
    if case is None:
        return None
    shore = Shore(0.5 * THIN, places=case.runup_place)
    sim, facts, readings = ran("monai", ["fluid.spacing=0.08", "time.end=2"] if quick else [], watch=shore)
    gauges = {f"g{n}": series for n, series in _read(sim, readings, "surface").items()}
    curves = {"runup": shore.near, "runup_measured": case.runup}
    return Case(facts, gauges, {n: case.gauges.of(n) for n in gauges}, curves)


def island(name, quick=False):
    """Conical island: surface at gauges, on the measured clock (crests at gauge 2 coincide), and run-up around it."""
    case = data.conical_island(name)
    if case is None:
        return None
    shore = Shore(THIN, case.centre)
    settings = ["fluid.spacing=0.3", "time.end=4"] if quick else []
    sim, facts, readings = ran("conical_island", [*settings, "output.maps=false"], None if name == "B" else name, shore)
    t_measured, y_measured = case.gauges.of("g2")
    t, y = _read(sim, readings, "surface", case.depth)["g2"]
    delay = norms.peak(t_measured, y_measured)[1] - norms.peak(t, y)[1]
    gauges = _read(sim, readings, "surface", case.depth, delay)
    facts |= {"delay": delay, "runup": shore.top - case.depth}
    angle = (22.5 * np.arange(16) + 90) % 360  # the table's: 270 faces the wave
    around = np.stack([angle, shore.around - case.depth], -1)
    return Case(facts, gauges, {n: case.gauges.of(n) for n in gauges}, {"runup": around, "runup_measured": case.runup})


def merewether(quick=False):
    """Merewether: stages at five marks, the mean of the last 60 s."""
    case = data.merewether()
    if case is None:
        return None
    settings = ["fluid.spacing=4", "time.end=40"] if quick else []
    sim, facts, readings = ran("merewether", [*settings, "output.maps=false"])
    gauges = _read(sim, readings, "surface")
    last = readings["time"] > readings["time"][-1] - (10.0 if quick else 60.0)
    marks = [case.marks[int(n)] for n in gauges]
    ny, nx = case.bed.shape
    ground = [
        float(case.bed[min(np.argmin(abs(case.y - y)), ny - 1), min(np.argmin(abs(case.x - x)), nx - 1)])
        for x, y, _ in marks
    ]
    curves = {
        "stage": np.array([y[last].mean() for _, y in gauges.values()]),
        "mark": np.array([m[2] for m in marks]),
        "bed": np.array(ground),
        "fv": np.array([case.published["fv"][int(n)] for n in gauges]),
        "tuflow": np.array([case.tuflow[int(n)][0] for n in gauges]),
    }
    return Case(facts, gauges, {}, curves)
