"""Weakly compressible SPH in the plane, as a baseline: equation of state for pressure, explicit viscosity.

Same kernel, spacing, walls and pair force of viscosity as the incompressible solvers of melt, so that what differs is how
pressure and viscosity are stepped. NumPy, double precision; axes x and z. Its limits are 0.25 h/c0 and 0.125 rho h^2/mu.
"""

import math

import numpy as np
from scipy.spatial import cKDTree

from melt.geometry.build import build
from melt.physics.phases import LIQUID, WALL

SKIN = 0.15  # of the support: pairs are listed anew when a particle may have moved half of it


class Plane:
    """A liquid of a two-dimensional scene, stepped by WCSPH.

    Args:
        scene: a `melt.scene.Scene` with ``domain.dimensions`` 2: its walls, first nozzle, fills and viscosity are used.
        mu: viscosity [Pa s], the scene's unless given.
        sound: speed of sound [m/s], ten times the speed of free fall from the nozzle (or the top of the fill) unless given.
    """

    def __init__(self, scene, mu=None, sound=None):
        start = build(scene)
        x, phase = start["position"][[0, 2]].T, start["phase"]
        self.d, self.h, self.rest = scene.spacing, scene.support, scene.fluid.density
        self.mu = (scene.viscosity.mu if scene.viscosity else 0.0) if mu is None else mu
        self.g = np.array(scene.domain.gravity)[[0, 2]]
        self.wall, self.wall_volume = x[phase == WALL], start["rest_volume"][phase == WALL]
        self.x, self.v = x[phase == LIQUID], start["velocity"][[0, 2]].T[phase == LIQUID]
        self.floor = (scene.viscosity.floor if scene.viscosity else 1e-4) * self.h**2
        self.nozzle, self.layers = (scene.inflow[0] if scene.inflow else None), 0
        if self.nozzle is not None:
            self.layer = start["inflow_position"][[0, 2]].T  # at its inner end
            self.outlet = self.nozzle.position[2]
        top = self.outlet if self.nozzle is not None else self.x[:, 1].max()
        fast = math.hypot(math.sqrt(2 * np.linalg.norm(self.g) * top), self.nozzle.speed if self.nozzle else 0.0)
        self.c0 = 10 * fast if sound is None else sound
        self.time, self.steps, self._moved = 0.0, 0, math.inf
        self.pressure = self.density = np.zeros(len(self.x))

    def limits(self):
        """Return the textbook limits of the step [s]: of sound, of explicit viscosity."""
        return 0.25 * self.h / self.c0, 0.125 * self.rest * self.h**2 / self.mu if self.mu else math.inf

    def _emit(self):
        if self.nozzle is None or self.layers >= self.nozzle.layers:
            return
        due = self.time * self.nozzle.speed / self.d - self.layers
        if due >= 0:
            new = self.layer + np.array([0.0, -due * self.d])
            self.x = np.vstack([self.x, new])
            self.v = np.vstack([self.v, np.tile([0.0, -self.nozzle.speed], (len(new), 1))])
            self.layers += 1
            self._moved = math.inf

    def _pairs(self):
        reach = (1 + SKIN) * self.h
        tree = cKDTree(self.x)
        self.pairs = tree.query_pairs(reach, output_type="ndarray").T
        near = tree.query_ball_tree(cKDTree(self.wall), reach) if len(self.wall) else [[]] * len(self.x)
        i = np.repeat(np.arange(len(self.x)), [len(k) for k in near])
        self.touch = i, np.array([b for k in near for b in k], np.int64)
        self._moved = 0.0

    def _kernel(self, dx):
        r = np.sqrt((dx * dx).sum(axis=1))
        q = r / self.h
        a, b = np.maximum(1 - q, 0), np.maximum(0.5 - q, 0)
        scale = 80 / (7 * math.pi * self.h**2)
        slope = -3 * scale / self.h * np.minimum(q, a) * (a + 2 * b)
        return r, scale * (a**3 - 4 * b**3), slope / np.maximum(r, 1e-9 * self.h)

    def step(self, dt):
        """Advance by ``dt`` [s]: densities, forces, then velocities before positions."""
        self._emit()
        n = len(self.x)
        if self._moved > 0.5 * SKIN * self.h:
            self._pairs()
        (i, j), (k, b) = self.pairs, self.touch
        mass, dim = self.rest * self.d**2, 2
        dx, db = self.x[i] - self.x[j], self.x[k] - self.wall[b]
        r, W, slope = self._kernel(dx)
        rb, Wb, slope_b = self._kernel(db)
        psi = self.rest * self.wall_volume[b]
        own = mass * 40 / (7 * math.pi * self.h**2)
        density = own + mass * (np.bincount(i, W, n) + np.bincount(j, W, n)) + np.bincount(k, psi * Wb, n)
        p = np.maximum(self.rest * self.c0**2 / 7 * ((density / self.rest) ** 7 - 1), 0)
        volume, share = mass / density, p / density**2
        dv = self.v[i] - self.v[j]
        near = 2 * (dim + 2) * self.mu * volume[i] * volume[j] * -slope / (r * r + self.floor)
        pull = -mass * (share[i] + share[j]) * slope - near * (dv * dx).sum(axis=1) / mass
        near_b = 2 * (dim + 2) * self.mu * volume[k] * self.wall_volume[b] * -slope_b / (rb * rb + self.floor)
        pull_b = -psi * (share[k] + p[k] / self.rest**2) * slope_b - near_b * (self.v[k] * db).sum(axis=1) / mass
        a = np.empty_like(self.x)
        for c in range(2):
            f, fb = pull * dx[:, c], pull_b * db[:, c]
            a[:, c] = np.bincount(i, f, n) - np.bincount(j, f, n) + np.bincount(k, fb, n) + self.g[c]
        self.v = self.v + dt * a
        if self.nozzle is not None:
            held = self.x[:, 1] > self.outlet
            self.v[held] = 0.0, -self.nozzle.speed
        self.x = self.x + dt * self.v
        self.pressure, self.density = p, density
        self.speed = float(np.sqrt((self.v**2).sum(axis=1).max())) if n else 0.0
        self._moved += dt * self.speed
        self.time += dt
        self.steps += 1


def largest_step(make, until, speed, first, halvings=12, refine=2):
    """Return (largest step that stays stable [s], smallest that does not) by halving from ``first``, then by bisection.

    A run is unstable whose speed exceeds ``speed`` [m/s] or is not a number before ``until`` [s] have passed.
    """

    def stable(dt):
        run = make()
        end = run.time + until
        with np.errstate(all="ignore"):
            while run.time < end:
                run.step(dt)
                if not run.speed < speed:
                    return False
        return True

    high, low = math.nan, first
    for _ in range(halvings):
        if stable(low):
            break
        high, low = low, low / 2
    for _ in range(refine if high == high else 0):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low, high
