"""Driven edges of a flood: sides with a given stage, depth or discharge. Flood spec E18, ADR 16.

What has to survive a checkpoint stands in ``do.clock.sources``, as plain numbers.
"""

import math
from dataclasses import dataclass

import numpy as np

from melt.errors import InputError
from melt.flood.hydrographs import Hydrograph
from melt.flood.open_boundary import boundary_state, inside_of
from melt.flood.tables import series_of

GOLDEN = (math.sqrt(5) - 1) / 2
PROBE = 2.0  # length of the strip in which the water beside an edge is measured, in supports
SIDES = {"west": (0, 1.0), "east": (0, -1.0), "south": (1, 1.0), "north": (1, -1.0)}  # axis, inward direction


@dataclass
class Edge:
    """A driven side: zone ``number`` of the fields ``zone_*``."""

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
    bed: float  # mean elevation along the side [m]
    datum: float
    volume: float  # of a column [m^3]
    far: bool = False  # the depth is that of still water far outside
    reach: float = 0.0  # from the strip to the middle of the probe [m]
    rise: float = 0.0  # of the bed from the side to the strip in which the water is measured, mean [m]

    @property
    def length(self):
        """Length of the side [m]."""
        return self.high - self.low

    def wanted(self, time):
        """Return the depth [m] or the discharge per width [m^2/s] that the side asks for."""
        value = self.given.value(time)
        if self.kind == "stage":
            return max(0.0, value - self.datum - self.bed)
        return value / self.length if self.kind == "discharge" else value

    def brought(self, start, stop, depth, speed):
        """Return the volume [m^3] that enters between two times where the edge has a depth and an inward speed."""
        if start >= self.until:
            return 0.0
        if self.kind == "discharge":
            return self.given.integral(start, stop)
        return max(0.0, speed) * depth * self.length * (stop - start)

    def due(self, kept, start, stop, most):
        """Return (places (n, 1, 2), velocities (n, 2)) of the columns that enter; the rest stays owed.

        They stand on a golden-ratio lattice, and as far in as they would have come since they were owed.
        """
        state = kept.setdefault(self.name, {"owed": 0.0, "emitted": 0, "depth": 0.0, "speed": 0.0})
        state["owed"] += self.brought(start, stop, state["depth"], state["speed"])
        n = max(0, min(int(state["owed"] / self.volume + 1e-9), most))
        age = state["owed"] - self.volume * (1 + np.arange(n))  # volume that came in behind each
        behind = age / (max(state["depth"], 1e-9) * self.length) if state["depth"] > 0 else np.zeros(n)
        along = self.low + (((state["emitted"] + np.arange(n)) * GOLDEN) % 1) * self.length
        state["owed"] -= n * self.volume
        state["emitted"] += n
        x, v = np.zeros((n, 1, 2)), np.zeros((n, 2))
        x[:, 0, self.axis] = self.at + self.inward * np.maximum(behind, 1e-6)
        x[:, 0, 1 - self.axis] = along
        v[:, self.axis] = self.inward * state["speed"]
        return x, v

    def drive(self, kept, time, inside_depth, inside_speed, gravity):
        """Return the inward speed that the columns of the strip take, NaN where the edge is left to itself."""
        if time >= self.until:
            return math.nan
        inside_depth, inside_speed = self._arrived(kept, time, inside_depth, inside_speed, gravity)
        wanted = self.wanted(time)
        given = {"discharge": wanted} if self.kind == "discharge" else {"far": (wanted, 0.0)} if self.far else {"depth": wanted}
        if self.kind == "stage" and inside_depth > 0:
            # level water has other depths over a bed that rises, and does not flow: stages are compared, discharge is kept
            level = max(inside_depth + self.rise, 0.1 * inside_depth)
            inside_depth, inside_speed = level, inside_speed * inside_depth / level
        found = boundary_state(inside_depth, inside_speed, gravity=gravity, **given)
        kept.setdefault(self.name, {"owed": 0.0, "emitted": 0}).update(depth=found.depth, speed=found.velocity)
        return found.velocity

    def _arrived(self, kept, time, depth, speed, gravity):
        """Return what has come from the middle of the probe to the strip by now: it lags by the way over c - v.

        Without the lag the strip moves ahead of the wave, and a wave of a few probes' length came back by a sixth.
        """
        state = kept.setdefault(self.name, {"owed": 0.0, "emitted": 0})
        before = state.get("arrived")
        if before is not None and depth > 0 and before[0] > 0:
            pace = math.sqrt(gravity * depth) - speed
            share = 1 - math.exp(-(time - before[2]) * max(pace, 0.0) / self.reach) if self.reach > 0 else 1.0
            depth, speed = before[0] + share * (depth - before[0]), before[1] + share * (speed - before[1])
        state["arrived"] = [float(depth), float(speed), float(time)]
        return depth, speed


def drive(do):
    """Give the columns of the driven strips their speed."""
    s = do.settings.sources
    do.zone_sums()
    sums = np.resize(np.asarray(do.read("zone_sums"), dtype=np.float64), (3, len(s.edges)))
    speeds = np.full(len(s.edges), np.nan)
    for edge in s.edges:
        speeds[edge.number] = edge.drive(do.clock.sources, do.clock.time, *inside_of(*sums[:, edge.number]), s.gravity)
    do.give("zone_speed", speeds)
    do.zone_drive()


def edges_of(scene, terrain):
    """Return the `Edge` list of a scene."""
    return [_edge(k, edge, scene, terrain) for k, edge in enumerate(scene.edge)]


def _edge(k, edge, scene, terrain):
    axis, inward = SIDES[edge.side]
    low, high = terrain.bounds
    z = terrain.elevation
    bed = {"west": z[:, 0], "east": z[:, -1], "south": z[0], "north": z[-1]}[edge.side]
    kind = next(name for name in ("stage", "depth", "discharge") if getattr(edge, name) is not None)
    given = series_of(getattr(edge, kind), f"edge {edge.side}")
    if kind != "stage" and (given.values < 0).any():
        remedy = "give 0 or more; water leaves over an edge by its stage or depth"
        raise InputError(f"{given.name}: a {kind} of {given.values.min():g}: {remedy}")
    return Edge(
        f"edge {edge.side}", k, kind, given, edge.until or math.inf, axis, inward,
        float(low[axis] if inward > 0 else high[axis]), float(low[1 - axis]), float(high[1 - axis]), float(bed.mean()), terrain.datum,
        scene.column_volume, edge.far,
    )


def zone_fields(edges, widths, terrain, support):
    """Return the arrays over zones: strips of driven water along the edges, and strips beside them that are measured."""
    low, high = terrain.bounds
    n = len(edges)
    box, probe, normal = np.zeros((4, n)), np.zeros((4, n)), np.zeros((2, n))
    for k, (edge, width) in enumerate(zip(edges, widths)):
        normal[edge.axis, k] = edge.inward
        for target, start, stop in ((box, -1e6, width), (probe, width, width + PROBE * support)):
            target[2 * edge.axis : 2 * edge.axis + 2, k] = sorted((edge.at + edge.inward * start, edge.at + edge.inward * stop))
            across = 1 - edge.axis
            target[2 * across : 2 * across + 2, k] = low[across] - 1.0, high[across] + 1.0
        edge.reach = 0.5 * PROBE * support
        edge.rise = _mean_bed(terrain, probe[:, k]) - edge.bed
    return {"zone_box": box, "zone_probe": probe, "zone_normal": normal, "zone_speed": np.zeros(n)}


def _mean_bed(terrain, box):
    """Return the mean elevation [m] of nodes in a box (x from, to, y from, to), or of those nearest to its middle."""
    x, y = terrain.x, terrain.y
    inside = [(a >= low) & (a <= high) for a, low, high in ((x, *box[:2]), (y, *box[2:]))]
    for k, (a, low, high) in enumerate(((x, *box[:2]), (y, *box[2:]))):
        if not inside[k].any():
            inside[k] = np.arange(a.size) == np.argmin(np.abs(a - 0.5 * (low + high)))
    return float(terrain.elevation[np.ix_(inside[1], inside[0])].mean())
