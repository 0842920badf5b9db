"""Water that enters a flood: inflows, driven edges, rain; and what drives the edges. Flood spec E17-E19.

What has to survive a checkpoint stands in ``do.clock.sources``, as plain numbers.
"""

import math
from dataclasses import dataclass

import numpy as np

from melt.errors import GeometryError
from melt.flood.hydrograph import Hydrograph, series_of
from melt.flood.open_boundary import from_depth, from_discharge
from melt.flood.walls import extent
from melt.geometry.outlines import inside
from melt.scene.flood_bodies import FloodObstacle

CANDIDATES = 8  # places tried for a column, of which the emptiest is taken (E17)
RAIN_CELL = 5.0  # side of the cells in which rain gathers, in spacings (E19)
GOLDEN = (math.sqrt(5) - 1) / 2
SIDES = {"west": (0, 1.0), "east": (0, -1.0), "south": (1, 1.0), "north": (1, -1.0)}  # axis, inward direction


@dataclass
class Rows:
    """Columns that enter together: candidate places (count, k, 2), velocity (count, 2), all of one volume."""

    places: np.ndarray
    velocity: np.ndarray
    volume: float

    @property
    def count(self):
        return len(self.places)


@dataclass
class Inflow:
    """A place with a discharge."""

    name: str
    discharge: Hydrograph  # m^3/s
    draw: object  # draw(random, n) -> places (n, 2)
    velocity: np.ndarray

    def brought(self, do, start, stop):
        """Return the volume [m^3] that enters between two times."""
        return self.discharge.integral(start, stop)

    def places(self, random, n, first, behind):
        """Return candidate places (n, k, 2) and velocities (n, 2) of ``n`` columns."""
        places = self.draw(random, n * CANDIDATES).reshape(n, CANDIDATES, 2)
        return places, np.tile(self.velocity, (n, 1))


@dataclass
class Rain:
    """Rain on the whole terrain."""

    name: str
    rate: Hydrograph  # m/s
    low: np.ndarray
    high: np.ndarray
    open_ground: object  # open_ground(x (2, n)) -> bool

    def brought(self, do, start, stop):
        return self.rate.integral(start, stop) * float(np.prod(self.high - self.low))

    def places(self, random, n, first, behind):
        """Cells of the plane in turn (a low-discrepancy sequence), each with candidates inside of it."""
        k = first + np.arange(n)
        middle = np.stack([(0.5 + 0.7548776662466927 * k) % 1, (0.5 + 0.5698402909980532 * k) % 1], axis=1)
        spread = np.sqrt(1.0 / max(n, 16)) * (random.random((n, CANDIDATES, 2)) - 0.5)
        share = np.clip(middle[:, None] + spread, 0, 1 - 1e-9)
        return self.low + share * (self.high - self.low), np.zeros((n, 2))


@dataclass
class Edge:
    """A driven side: zone k of the fields ``zone_*``."""

    name: str
    number: int
    kind: str  # "stage", "depth" or "discharge"
    given: Hydrograph
    until: float
    axis: int
    inward: float
    at: float  # coordinate of the side [m]
    low: float  # along the side [m]
    high: float
    bed: float  # mean bed elevation along the side [m]
    datum: float

    def wanted(self, time):
        """Return the depth [m] or the discharge per width [m^2/s] that the side asks for."""
        value = self.given.value(time)
        if self.kind == "stage":
            return max(0.0, value - self.datum - self.bed)
        return value / (self.high - self.low) if self.kind == "discharge" else value

    def brought(self, do, start, stop):
        if start >= self.until:
            return 0.0
        if self.kind == "discharge":
            return self.given.integral(start, stop)
        depth, speed = do.clock.sources.get(f"{self.name} flow", [0.0, 0.0])
        return max(0.0, speed) * depth * (self.high - self.low) * (stop - start)

    def speed(self, do):
        """Return the depth and inward speed of the newest columns."""
        return do.clock.sources.get(f"{self.name} flow", [self.wanted(do.clock.time), 0.0])

    def flowing(self, behind, depth, speed, n, first):
        """Return places (n, 1, 2) and velocities (n, 2): on a golden-ratio lattice, the oldest furthest in."""
        along = self.low + (((first + np.arange(n)) * GOLDEN) % 1) * (self.high - self.low)
        x = np.zeros((n, 1, 2))
        x[:, 0, self.axis] = self.at + self.inward * np.maximum(behind, 1e-6)
        x[:, 0, 1 - self.axis] = along
        v = np.zeros((n, 2))
        v[:, self.axis] = self.inward * speed
        return x, v


class Sources:
    """All sources of a scene."""

    def __init__(self, scene, terrain):
        self.volume = scene.column_volume
        self.spacing = scene.spacing
        self.gravity, self.seed = scene.gravity, scene.fluid.seed
        self.support = scene.support
        self.terrain = terrain
        self.items = [_inflow(inflow, terrain) for inflow in scene.inflow]
        if scene.rain is not None:
            self.items.append(_rain(scene, terrain))
        self.edges = [_edge(k, edge, scene, terrain) for k, edge in enumerate(scene.edge)]
        self.widths = [edge.width * scene.support for edge in scene.edge]

    def expected_volume(self, end):
        """Return the volume [m^3] that enters until ``end`` [s], as far as it is known: edges with a stage are guessed."""
        total = sum(item.brought(None, 0.0, end) for item in self.items)
        for edge in self.edges:
            stop = min(end, edge.until)
            if edge.kind == "discharge":
                total += edge.given.integral(0.0, stop)
                continue
            times = np.linspace(0.0, stop, 400)
            depth = np.array([edge.wanted(t) for t in times])
            wave = math.sqrt(self.gravity * max(depth.max(initial=0.0), 1e-9))
            # what a wave above the first level carries in, and a little for what the water inside asks for
            above = np.maximum(depth - depth[0], 0.0).mean() + 0.02 * depth.max(initial=0.0)
            total += (edge.high - edge.low) * wave * stop * above
        return total

    def zone_fields(self):
        """Return the arrays over zones: strips of driven water along the edges, and strips beside them that are measured."""
        low, high = self.terrain.bounds
        n = len(self.edges)
        box, probe, normal = np.zeros((4, n)), np.zeros((4, n)), np.zeros((2, n))
        for k, (edge, width) in enumerate(zip(self.edges, self.widths)):
            normal[edge.axis, k] = edge.inward
            for target, start, stop in ((box, -1e6, width), (probe, width, width + 2 * self.support)):
                ends = sorted((edge.at + edge.inward * start, edge.at + edge.inward * stop))
                target[2 * edge.axis : 2 * edge.axis + 2, k] = ends
                target[2 * (1 - edge.axis) : 2 * (1 - edge.axis) + 2, k] = low[1 - edge.axis] - 1.0, high[1 - edge.axis] + 1.0
        return {"zone_box": box, "zone_probe": probe, "zone_normal": normal, "zone_speed": np.full(n, np.nan)}


def entries(do, dt):
    """Yield the `Rows` that enter in the outer step from now on, and keep what is owed for later (E17)."""
    sources, kept = do.settings.sources, do.clock.sources
    start, stop = do.clock.time, do.clock.time + dt
    for item in [*sources.items, *sources.edges]:
        owed, emitted = kept.get(item.name, [0.0, 0])
        owed += item.brought(do, start, stop)
        n = int(owed // sources.volume)
        while n > 0:
            depth, speed = item.speed(do) if isinstance(item, Edge) else (0.0, 0.0)
            most = do.size("entry") // (1 if isinstance(item, Edge) else CANDIDATES)
            batch = min(n, most)
            random = np.random.Generator(np.random.Philox(key=[sources.seed, hash_of(item.name)], counter=[0, 0, 0, emitted]))
            if isinstance(item, Edge):
                # the first of them came in when what is owed reached one column
                age = owed - sources.volume * (1 + np.arange(batch))
                behind = age / (max(depth, 1e-6) * (item.high - item.low))
                places, velocity = item.flowing(behind, depth, speed, batch, emitted)
            else:
                places, velocity = item.places(random, batch, emitted, None)
            owed, emitted, n = owed - batch * sources.volume, emitted + batch, n - batch
            yield Rows(places, velocity, sources.volume)
        kept[item.name] = [owed, emitted]


def choose(do, rows):
    """Take the emptiest of the candidate places of each column (E17) and hand the rows to the backend."""
    n, k, _ = rows.places.shape
    best = np.zeros(n, np.int64)
    if k > 1:
        _set(do, "entry_position", rows.places.reshape(n * k, 2))
        do.entry_clearance()
        free = np.asarray(do.read("entry_clearance"), float)[: n * k].reshape(n, k)
        taken = np.zeros((0, 2))
        for i in range(n):  # the ones before it in the batch take room, too
            room = free[i]
            if len(taken):
                room = np.minimum(room, np.sqrt(((rows.places[i][:, None] - taken[None]) ** 2).sum(axis=2)).min(axis=1))
            best[i] = int(np.argmax(room))
            taken = np.vstack([taken, rows.places[i, best[i]]])
    _set(do, "entry_position", rows.places[np.arange(n), best])
    _set(do, "entry_velocity", rows.velocity)
    volume = np.zeros(do.size("entry"))
    volume[:n] = rows.volume
    do.state.set("entry_volume", volume)
    real = do.state.get("entry_volume").dtype.type
    ledger = do.clock.ledger
    ledger["entered"] = ledger.get("entered", 0.0) + n * float(real(rows.volume))


def _set(do, name, values):
    """Fill the rows of a plane vector field over entries."""
    padded = np.zeros((3, do.size("entry")))
    padded[:2, : len(values)] = values.T
    do.state.set(name, padded)


def drive(do, sub_dt):
    """Give the columns of the driven edges their speed (E18)."""
    s = do.settings.sources
    do.zone_sums()
    area, flow, volume = np.asarray(do.read("zone_sums"), dtype=np.float64)
    speeds = np.full(len(s.edges), np.nan)
    for edge in s.edges:
        k = edge.number
        if do.clock.time >= edge.until:
            continue
        inside_depth = volume[k] / area[k] if area[k] > 0 else 0.0
        inside_speed = flow[k] / volume[k] if volume[k] > 0 else 0.0
        wanted = edge.wanted(do.clock.time)
        given = from_discharge if edge.kind == "discharge" else from_depth
        depth, speeds[k] = given(wanted, inside_depth, inside_speed, s.gravity)
        do.clock.sources[f"{edge.name} flow"] = [float(depth), float(speeds[k])]
    do.state.set("zone_speed", speeds)
    do.zone_drive()


def read_gauges(do):
    """Keep what the gauges read now; elevations are the world's."""
    s, nodes = do.settings, do.settings.nodes
    reading = {"time": do.clock.time}
    for name in ("surface", "depth", "speed"):
        values = np.asarray(do.read(f"sample_{name}"), dtype=np.float64)[nodes:]
        reading[name] = (values + s.datum if name == "surface" else values).tolist()
    do.clock.readings.append(reading)


def hash_of(name):
    """Return a number of 63 bits that a name always has."""
    value = 0xCBF29CE484222325
    for byte in name.encode():
        value = ((value ^ byte) * 0x100000001B3) % (1 << 64)
    return value >> 1


def _inflow(inflow, terrain):
    """Return the `Inflow` of a scene's table.

    Raises:
        GeometryError: its place lies outside of the terrain.
    """
    low, high = terrain.bounds
    if inflow.line is not None:
        a, b = (terrain.local(p) for p in inflow.line)
        corners = np.stack([a, b], axis=1)

        def draw(random, n):
            return a + random.random((n, 1)) * (b - a)
    elif inflow.polygon is not None:
        outline = FloodObstacle(shape="polygon", polygon=terrain.local(np.array(inflow.polygon).T).T.tolist())
        corners = np.array(outline.polygon).T

        def draw(random, n):
            return _within(random, n, corners.min(axis=1), corners.max(axis=1), lambda x: inside(outline, x))
    else:
        centre = terrain.local(inflow.centre)
        corners = centre[:, None] + np.array([[-1, 1], [-1, 1]]) * 0.0

        def draw(random, n):
            r, turn = inflow.radius * np.sqrt(random.random(n)), 2 * np.pi * random.random(n)
            return centre + np.stack([r * np.cos(turn), r * np.sin(turn)], axis=1)

    if (corners.min(axis=1) < low).any() or (corners.max(axis=1) > high).any():
        raise GeometryError(f"inflow {inflow.name!r} lies outside of the terrain, {extent(terrain)}: move it, or widen the terrain")
    return Inflow(f"inflow {inflow.name}", series_of(inflow.discharge, "discharge"), draw, np.array(inflow.velocity))


def _within(random, n, low, high, accepted):
    """Return n random places in a region, by rejection; `GeometryError` if it has no inside."""
    found, tries = np.zeros((0, 2)), 0
    while len(found) < n:
        x = low + random.random((4 * n, 2)) * (high - low)
        found = np.vstack([found, x[accepted(x.T)]])
        tries += 1
        if tries > 200:
            raise GeometryError("an inflow's polygon has no inside: check the order of its corners")
    return found[:n]


def _rain(scene, terrain):
    low, high = terrain.bounds
    return Rain("rain", series_of(scene.rain.rate, "rate"), low, high, None)


def _edge(k, edge, scene, terrain):
    """Return the `Edge` of a scene's table."""
    axis, inward = SIDES[edge.side]
    low, high = terrain.bounds
    bed = {"west": terrain.elevation[:, 0], "east": terrain.elevation[:, -1], "south": terrain.elevation[0], "north": terrain.elevation[-1]}
    kind = next(name for name in ("stage", "depth", "discharge") if getattr(edge, name) is not None)
    return Edge(
        f"edge {edge.side}", k, kind, series_of(getattr(edge, kind), kind), edge.until or math.inf, axis, inward,
        float(low[axis] if inward > 0 else high[axis]), float(low[1 - axis]), float(high[1 - axis]), float(bed[edge.side].mean()), terrain.datum,
    )
