"""Dam break: pressure on the end wall against 100 repeated experiments (V11).

Lobovsky et al. 2014: a column 0.6 m x 0.3 m in a tank 1.610 m long; pressure over rho g H at the end wall, 30 mm above
the floor, over T = t sqrt(g / H). Measured here is the load: the force of the liquid on the two rows of wall particles
around the sensor, over their area. Judged are the impulse up to T = 7 (15 %) and the mean over T = 3.5 to 5 (the band of
95 % of the runs); the peak lasts for milliseconds and is given without a claim.
"""

import csv

import h5py
import numpy as np

from experiments import Row
from melt.physics.phases import LIQUID, WALL
from melt.scene import scene_from_dict
from melt.scene.load import data_folder
from melt.simulation import Simulation

G, H, LENGTH, COLUMN, SENSOR = 9.81, 0.3, 1.61, 0.6, 0.03


def tank(dx, width):
    """Return the scene: a slab ``width`` spacings wide between free-slip walls."""
    length = round(LENGTH / dx) * dx
    return scene_from_dict({
        "time": {"end": 1.25, "dt": 0.001},
        "domain": {"upper": [length, width * dx, 0.9], "spacing": dx},
        "fluid": {"wall_friction": 0.0, "fill": [{"lower": [0, 0, 0], "upper": [COLUMN, width * dx, H]}]},
    })


class Sensor:
    """Wall particles of the end wall around 30 mm height, and the load on them."""

    def __init__(self, sim):
        self.sim, self.dx = sim, sim.scene.spacing
        self.end = sim.initial.domain_upper[0]
        x = sim.read("position")[sim.read("phase") == WALL].astype(float)
        near = (x[:, 0] > self.end) & (np.abs(x[:, 2] - SENSOR) < max(1.01 * self.dx, 0.01))
        near &= (x[:, 1] > 0) & (x[:, 1] < sim.initial.domain_upper[1])
        self.wall = x[near]
        self.area = len(np.unique(np.round(self.wall[:, 1:] / self.dx, 3), axis=0)) * self.dx**2

    def load(self):
        """Return the normal force of the liquid on the wall over its area [Pa], pair by pair as (2') has it."""
        sim, h = self.sim, self.sim.scene.support
        fields = (sim.read(n).astype(float) for n in ("position", "pressure", "density", "boundary_pressure"))
        x, p, rho, around = fields
        reach = (sim.read("phase") == LIQUID) & (x[:, 0] > self.end - h) & (x[:, 2] < self.wall[:, 2].max() + h)
        x, p, rho, around = x[reach], p[reach, None], rho[reach, None], around[reach, None]
        d = x[:, None] - self.wall
        r = np.sqrt((d**2).sum(axis=2))
        q = r / h
        slope = np.where(q <= 0.5, 18 * q**2 - 12 * q, -6 * np.clip(1 - q, 0, None) ** 2) * 8 / np.pi / h**4
        head = np.clip(-G * rho * d[..., 2], -np.abs(around), np.abs(around))
        push = p * (1000 / rho) ** 2 + around - head
        return float((self.dx**6 * push * slope * d[..., 0] / r).sum()) / self.area


def run(out, quick=False, say=print):
    """Run to T = 7 with 20 spacings to the column's height (``quick``: 10, to T = 4)."""
    dx, width = (0.03, 5) if quick else (0.015, 6)
    sim = Simulation(tank(dx, width), "cpu")
    sensor, T, p, X = Sensor(sim), [], [], []
    while not T or T[-1] < (4.0 if quick else 7.0):
        sim.step()
        T.append(sim.time * np.sqrt(G / H))
        p.append(sensor.load() / (1000 * G * H))
        X.append(float(sim.read("position")[sim.read("phase") == LIQUID, 0].max()))
    say(f"impact: {len(T)} steps, peak {max(p):.2f} at T = {T[int(np.argmax(p))]:.2f}")
    with h5py.File(out, "w") as file:
        file["T"], file["p"], file["front"] = T, p, X
        liquid = sim.read("phase") == LIQUID
        file.attrs.update(quick=quick, particles=int(liquid.sum()), floor=float(sim.read("position")[liquid, 2].min()) / dx)


def band():
    """Return T and the 2.5 %, 50 % and 97.5 % percentiles of the experiment, (4, n)."""
    with open(data_folder() / "measured" / "lobovsky_2014_H300_sensor2.csv") as file:
        return np.array([[float(v) for v in row] for row in csv.reader(file) if not row[0].startswith("#")]).T


def mean(T, p, first, last):
    """Return the mean of p over T between ``first`` and ``last``."""
    t = np.linspace(first, last, 1000)
    return float(np.interp(t, T, p).mean())


def report(path):
    """Return the rows."""
    with h5py.File(path) as file:
        T, p, attrs = file["T"][()], file["p"][()], dict(file.attrs)
    t, low, middle, high = band()
    claimed = not attrs["quick"]
    note = f"{attrs['particles']:,} liquid particles; lowest in the end {attrs['floor']:.2f} dx above the floor"
    smooth = np.convolve(p, np.ones(5) / 5, "same")  # 5 ms, as wide as the two rows are coarse
    rows = [Row("V11 impact: first p > 0.2", f"T = {t[np.argmax(middle > 0.2)]:.2f}", f"T = {T[np.argmax(smooth > 0.2)]:.2f}",
                "", None, note),
            Row("V11 impact: peak (mean over 5 ms)", f"{middle.max():.2f}", f"{smooth.max():.2f}", "", None)]
    if claimed:
        ours, theirs = mean(T, p, 0, 7) * 7, mean(t, middle, 0, 7) * 7
        rows.append(Row("V11 impact: impulse up to T = 7", f"{theirs:.2f}", f"{ours:.2f}", "+- 15 %",
                        bool(abs(ours / theirs - 1) <= 0.15)))
        level = [mean(t, percentile, 3.5, 5) for percentile in (low, middle, high)]
        ours = mean(T, p, 3.5, 5)
        rows.append(Row("V11 impact: mean over T = 3.5 to 5", f"{level[1]:.2f}", f"{ours:.2f}",
                        f"{level[0]:.2f} to {level[2]:.2f}", bool(level[0] <= ours <= level[2])))
    return rows
