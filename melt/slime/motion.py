"""Bodies that move as a scene tells them: where their centre is and how fast it moves. Slime spec 8."""

from typing import NamedTuple

import numpy as np


class Body(NamedTuple):
    """One moving body of a scene; particles of it have its number in `driver`."""

    number: int
    velocity: np.ndarray  # [m/s]
    spin: np.ndarray  # [1/s]
    centre: np.ndarray  # at t = 0 [m]
    times: np.ndarray  # of the given motion [s]; empty: velocity is constant
    speeds: np.ndarray  # (k, 3), linear between the times [m/s]

    @classmethod
    def of(cls, obstacle, number):
        """Return the body of an obstacle of the scene."""
        rows = np.array(obstacle.motion, float).reshape(-1, 4)
        if obstacle.position is not None:
            centre = np.array(obstacle.position, float)
        else:
            centre = 0.5 * (np.array(obstacle.lower, float) + np.array(obstacle.upper, float))
        return cls(number, np.array(obstacle.velocity, float), np.array(obstacle.spin, float), centre, rows[:, 0], rows[:, 1:])

    def speed(self, time):
        """Return the velocity (3,) of the centre at a time."""
        if not self.times.size:
            return self.velocity
        return np.array([np.interp(time, self.times, self.speeds[:, k]) for k in range(3)])

    def shift(self, time):
        """Return how far the centre has moved since t = 0 (3,): the exact integral of the given motion."""
        if not self.times.size:
            return self.velocity * time
        t = np.concatenate([self.times[self.times < time], [time]])
        t = np.concatenate([[0.0], t[t > 0]])
        v = np.array([self.speed(s) for s in t])
        return ((v[1:] + v[:-1]) / 2 * np.diff(t)[:, None]).sum(axis=0)


def motion_of(bodies, time, dt):
    """Return `driver_motion` (10, b) that brings the bodies from ``time`` to ``time + dt`` exactly.

    Mean velocity, spin, centre, and k: of a turn by a = |spin| dt the chord is Omega x r + k Omega x (Omega x r) with
    Omega = spin sin(a)/a and k = (1 - cos a)/(dt |Omega|^2). Without it a body that spins grows in every step.
    """
    rows = []
    for body in bodies:
        start, stop = body.shift(time), body.shift(time + dt)
        angle = float(np.linalg.norm(body.spin)) * dt
        spin = body.spin * np.sinc(angle / np.pi)
        k = (1 - np.cos(angle)) / (dt * (spin @ spin)) if spin.any() else 0.0
        rows.append(np.concatenate([(stop - start) / dt, spin, body.centre + start, [k]]))
    return np.array(rows).T.reshape(10, len(bodies))
