"""Measures of a dripping thread that every method is judged by: area, folds, compression."""

import numpy as np
from scipy.ndimage import distance_transform_edt

from melt.physics.phases import LIQUID, WALL


def area(x, spacing, finest=8):
    """Return the area [m^2] of the plane that particles x (n, 2) fill: closed at 0.9 spacings, less the margin of half a spacing.

    Closing (dilation by 0.9 spacings, erosion by 0.4) leaves a lattice its own area whatever its outline, so that a thread
    that folds does not seem to shrink; voids narrower than 1.8 spacings count as liquid.
    """
    pixel = spacing / finest
    low = x.min(axis=0) - 3 * spacing
    shape = np.ceil((x.max(axis=0) + 3 * spacing - low) / pixel).astype(int) + 1
    if not np.isfinite(shape).all() or shape.prod() > 40_000_000:
        return np.nan
    empty = np.ones(shape, bool)
    cells = np.round((x - low) / pixel).astype(int)
    empty[cells[:, 0], cells[:, 1]] = False
    wet = distance_transform_edt(empty) <= 0.9 * finest
    return float((distance_transform_edt(wet) > 0.4 * finest).sum() * pixel**2)


def entered(sim):
    """Return (how many particles the nozzles have let in, which of them each liquid particle is).

    Particles that the method added later have numbers beyond.
    """
    phase = sim.read("phase")
    number = np.flatnonzero(phase == LIQUID) - int((phase == WALL).sum())  # walls have the lowest ids
    return sum(sim.do.clock.entered.get(nozzle.name, 0) * nozzle.count for nozzle in sim.initial.nozzles), number


class Landing:
    """Where and when layers of a thread come to rest: the lateral position of its axis at the plate, over time; how fast they fall.

    Args:
        per_layer: particles in a layer of the nozzle.
        speed: of the nozzle [m/s]; a layer has landed when it falls at less than a third of it.
        outlet: height of the nozzle [m]; a layer is looked at below 0.9 of it.
    """

    def __init__(self, per_layer, speed, outlet):
        self.per_layer, self.speed, self.outlet = per_layer, speed, outlet
        self.found = {}  # layer: (time, lateral position)
        self.fastest = []  # (time, speed of the layer that falls fastest)

    def look(self, time, number, x, v):
        """Note the layers that have landed by now; x, v (n, 2 or 3), height last, of particles that entered as the ``number``-th."""
        layer = number // self.per_layer
        count = np.maximum(np.bincount(layer), 1e-9)
        *lateral, height, fall = (np.bincount(layer, a) / count for a in (*x.T, v[:, -1]))
        whole = count > 0.5 * self.per_layer
        if whole.any():
            self.fastest.append((time, -float(fall[whole].min())))
        for k in np.flatnonzero(whole & (fall > -self.speed / 3) & (height < 0.9 * self.outlet)):
            self.found.setdefault(int(k), (time, *(float(a[k]) for a in lateral)))

    def line(self):
        """Return (times, lateral positions (n,), in space (n, 2)) along the thread: by layer, as several land between two looks."""
        rows = np.array([self.found[k] for k in sorted(self.found)])
        rows = rows if len(rows) else np.zeros((0, 2))
        return np.maximum.accumulate(rows[:, 0]), rows[:, 1] if rows.shape[1] == 2 else rows[:, 1:]

    def contact(self):
        """Return the speed [m/s] of the thread where it meets what has landed: mean of the fastest layer's since the first landed."""
        first = min((row[0] for row in self.found.values()), default=np.inf)
        speeds = [speed for time, speed in self.fastest if time >= first]
        return float(np.mean(speeds)) if speeds else np.nan


def folds(times, lateral, least):
    """Return (number of reversals of the lateral motion, their frequency in full periods [Hz]).

    A reversal counts when the axis has come back by ``least`` [m] from its farthest point.
    """
    if len(lateral) == 0:
        return 0, np.nan
    turns, way = [], 0
    left = right = (lateral[0], times[0])  # farthest points since the last turn; it starts from no farthest point
    for t, x in zip(times, lateral):
        left = (x, t) if x < left[0] else left
        right = (x, t) if x > right[0] else right
        for side, far in ((1, right), (-1, left)):
            if way in (0, side) and side * (far[0] - x) >= least:
                turns, way = turns + [far[1]] * bool(far[1] > times[0]), -side
                left = right = (x, t)
                break
    rate = (len(turns) - 1) / 2 / (turns[-1] - turns[0]) if len(turns) > 1 and turns[-1] > turns[0] else np.nan
    return len(turns), rate


def compression(ratio):
    """Return (mean, largest) excess of density over the rest density."""
    over = np.maximum(ratio - 1, 0)
    return float(over.mean()), float(over.max())
