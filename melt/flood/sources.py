"""Water that enters a flood: inflows, rain, driven edges; and what the gauges read. Flood spec E17-E19."""

import math
from dataclasses import dataclass

import numpy as np

from melt.errors import GeometryError
from melt.flood.edges import edges_of, zone_fields
from melt.flood.hydrographs import CANDIDATES, Emitter, Rain, emptiest
from melt.flood.tables import series_of
from melt.flood.walls import extent
from melt.geometry.regions import Disc, Line, Polygon

RAIN_CELL = 5.0  # side of the cells in which rain gathers, in spacings (E19)


@dataclass
class Rows:
    """Columns that enter together, all of one volume [m^3]: candidate places (n, k, 2) [m], velocities (n, 2) [m/s]."""

    places: np.ndarray
    velocity: np.ndarray
    volume: float

    @property
    def count(self):
        return len(self.places)


class Sources:
    """All sources of a scene: ``emitters`` (name -> `Emitter` or `Rain`) and ``edges``."""

    def __init__(self, scene, terrain):
        self.volume, self.gravity = scene.column_volume, scene.gravity
        self.emitters = {}
        for k, inflow in enumerate(scene.inflow):
            discharge = series_of(inflow.discharge, f"inflow {inflow.name!r}")
            name = f"inflow {inflow.name}"
            self.emitters[name] = Emitter(discharge, _region(inflow, terrain), self.volume, scene.fluid.seed, k)
            self.emitters[name].speed = np.array(inflow.velocity)
        if scene.rain is not None:
            low, high = terrain.bounds
            rate = series_of(scene.rain.rate, "rain")
            dry = _share_open(terrain, RAIN_CELL * scene.spacing)
            self.emitters["rain"] = Rain(rate, low, high, RAIN_CELL * scene.spacing, self.volume, dry, scene.fluid.seed, 1 << 20)
            self.emitters["rain"].speed = np.zeros(2)
        self.edges = edges_of(scene, terrain)
        self._zones = zone_fields(self.edges, [edge.width * scene.support for edge in scene.edge], terrain, scene.support)

    def zone_fields(self):
        """Return the arrays over driven edges."""
        return self._zones

    def expected_volume(self, end):
        """Return the volume [m^3] that enters until ``end`` [s], as far as it is known: edges with a stage are guessed."""
        total = sum(float(np.sum(e.owed(end))) for e in self.emitters.values())
        for edge in self.edges:
            stop = min(end, edge.until)
            if edge.kind == "discharge":
                total += edge.given.integral(0.0, stop)
                continue
            depth = np.array([edge.wanted(t) for t in np.linspace(0.0, stop, 400)])
            wave = math.sqrt(self.gravity * max(depth.max(initial=0.0), 1e-9))
            # what a wave above the first level carries in, and a little for what the water inside asks for
            above = np.maximum(depth - depth[0], 0.0).mean() + 0.02 * depth.max(initial=0.0)
            total += edge.length * wave * stop * above
        return total


def entries(do, dt):
    """Yield the `Rows` that enter in the outer step from now on, as far as there is room; the rest stays owed (E17)."""
    sources, kept = do.settings.sources, do.clock.sources
    if do.recording:
        yield Rows(np.zeros((1, CANDIDATES, 2)), np.zeros((1, 2)), sources.volume)
        return
    start, stop = do.clock.time, do.clock.time + dt
    rows = do.size("entry")
    for name, emitter in sources.emitters.items():
        emitter.state = kept.setdefault(name, {**emitter.start})
        while (room := do.settings.capacity - do.clock.active) > 0:
            places = emitter.emit(stop, min(room, rows // CANDIDATES))
            if not len(places):
                break
            yield Rows(places, np.tile(emitter.speed, (len(places), 1)), sources.volume)
        if room <= 0 and float(np.sum(emitter.owed(stop))) >= sources.volume:
            do.note("inflow_stopped", do.clock.step + 1)
    for edge in sources.edges:
        while True:
            room = do.settings.capacity - do.clock.active
            places, velocity = edge.due(kept, start, stop, min(room, rows))
            start = stop  # what the step brings is owed once
            if not len(places):
                break
            yield Rows(places, velocity, sources.volume)
        if room <= 0 and kept[edge.name]["owed"] >= sources.volume:
            do.note("inflow_stopped", do.clock.step + 1)
        start = do.clock.time


def choose(do, rows):
    """Take the emptiest of the candidate places of each column (E17) and hand the rows to the backend."""
    n, k, _ = rows.places.shape
    places = rows.places[:, 0]
    if k > 1:
        _set(do, "entry_position", rows.places.reshape(n * k, 2))
        do.entry_clearance()
        free = np.resize(np.asarray(do.read("entry_clearance"), float)[: n * k], (n, k))
        places = emptiest(rows.places, free)
    _set(do, "entry_position", places)
    _set(do, "entry_velocity", rows.velocity)
    volume = np.zeros(do.size("entry"))
    volume[:n] = rows.volume
    do.give("entry_volume", volume)
    ledger = do.clock.ledger
    ledger["entered"] = ledger.get("entered", 0.0) + n * float(do.settings.real(rows.volume))  # as the columns have it


def _set(do, name, values):
    """Fill the rows of a plane vector field over entries."""
    padded = np.zeros((3, do.size("entry")))
    padded[:2, : len(values)] = values.T
    do.give(name, padded)


def read_gauges(do):
    """Keep what the gauges read now; elevations are the world's."""
    s, nodes = do.settings, do.settings.nodes
    reading = {"time": do.clock.time}
    for name in ("surface", "depth", "speed"):
        values = np.asarray(do.read(f"sample_{name}"), dtype=np.float64)[nodes:]
        reading[name] = (values + s.datum if name == "surface" else values).tolist()
    do.clock.readings.append(reading)


def _region(inflow, terrain):
    """Return the region of an inflow in local coordinates.

    Raises:
        GeometryError: it lies outside of the terrain.
    """
    if inflow.centre is not None:
        centre = terrain.local(inflow.centre)
        region, corners = Disc(centre, inflow.radius), np.stack([centre - inflow.radius, centre + inflow.radius], axis=1)
    else:
        corners = terrain.local(np.array(inflow.polygon or inflow.line).T)
        region = (Polygon if inflow.polygon else Line)(corners.T)
    low, high = terrain.bounds
    if (corners.min(axis=1) < low).any() or (corners.max(axis=1) > high).any():
        raise GeometryError(f"inflow {inflow.name!r} lies outside of the terrain, {extent(terrain)}: move it, or widen the terrain")
    tried = region.points(np.random.default_rng(0).random((256, 2))).T  # what enters on blocked ground is taken out again
    row, column = (np.clip(k, 0, n - 1) for k, n in zip(terrain.node(tried), terrain.shape))
    if terrain.blocked[row, column].mean() > 0.5:
        raise GeometryError(f"inflow {inflow.name!r} lies on blocked ground (no elevation, or a wall): move it")
    return region


def _share_open(terrain, side):
    """Return the share (ny, nx) of each rain cell that is no wall, taken at its nodes."""
    low, high = terrain.bounds
    count = [int(math.ceil((b - a) / side - 1e-9)) for a, b in zip(low, high)]
    i = np.minimum(((terrain.x - low[0]) / side).astype(int), count[0] - 1)
    j = np.minimum(((terrain.y - low[1]) / side).astype(int), count[1] - 1)
    where = (j[:, None] * count[0] + i[None, :]).ravel()
    size = count[0] * count[1]
    nodes = np.bincount(where, minlength=size)
    free = np.bincount(where, (~terrain.blocked).ravel(), minlength=size)
    return np.where(nodes > 0, free / np.maximum(nodes, 1), 1.0).reshape(count[1], count[0])


