"""Integration, and what the choice of the next step needs to know. Melting spec 2.6, 6."""

import numpy as np

PIECES = 64  # of a fixed-shape reduction: piece p covers particles p n/64 to (p + 1) n/64


def _mobile(phase):
    return (phase == 0) | (phase == 1)


def kick(phase, mass, force, dt, velocity):
    """Write v += dt F/m of liquid and solid particles (leap-frog, line 14).

    Reads: phase (n,), mass (n,) [kg], force (3, n) [N], dt [s]. Writes: velocity (3, n) [m/s].
    """
    move = _mobile(phase)
    velocity[:, move] += float(dt) * force[:, move].astype(np.float64) / mass[move]


def goal_kick(site_particle, goal, lattice, dt, velocity):
    """Write v += alpha_lsm (g - x)/dt of the particle of each live site.

    Reads: site_particle (s,), goal (3, s) = g - x [m], dt [s]. Writes: velocity (3, n) [m/s].
    """
    live = site_particle >= 0
    g = goal[:, live].astype(np.float64)
    velocity[:, site_particle[live]] += float(lattice.stiffness) * g / float(dt)


def goal_move(site_particle, goal, lattice, position):
    """Write x += alpha_lsm (g - x) of the particle of each live site: `goal_kick` where positions give velocities.

    Reads: site_particle (s,), goal (3, s) = g - x [m]. Writes: position (3, n) [m].
    """
    live = site_particle >= 0
    position[:, site_particle[live]] += float(lattice.stiffness) * goal[:, live].astype(np.float64)


def drift(phase, velocity, dt, position):
    """Write x += dt v of liquid and solid particles.

    Reads: phase (n,), velocity (3, n) [m/s], dt [s]. Writes: position (3, n) [m].
    """
    move = _mobile(phase)
    position[:, move] += float(dt) * velocity[:, move].astype(np.float64)


def leave_domain(position, domain, phase):
    """Make liquid particles inactive that left the box, if so chosen.

    Solids stay: a lattice site must keep its particle, the body flies on. So does a particle whose
    position is not finite: that is a fault, which the host reports; it must not vanish unseen.
    Reads: position (3, n) [m]. Writes: phase (n,).
    """
    lower = np.array([[domain.lower_x], [domain.lower_y], [domain.lower_z]], dtype=np.float64)
    upper = np.array([[domain.upper_x], [domain.upper_y], [domain.upper_z]], dtype=np.float64)
    outside = (np.isfinite(position).all(axis=0)) & ((position < lower) | (position > upper)).any(axis=0)
    if domain.delete == 1:
        phase[(phase == 0) & outside] = 5


def motion_bounds(phase, mass, velocity, force, motion_bounds):
    """Write 64 partial maxima of speed and of |F|/m over liquid and solid particles.

    A NaN counts as infinite, so that the host notices it.
    Reads: phase (n,), mass (n,) [kg], velocity (3, n) [m/s], force (3, n) [N].
    Writes: motion_bounds (2, 64) [m/s, m/s^2]; 0 for a piece without mobile particles.
    """
    n = len(phase)
    move = _mobile(phase)
    m = np.where(move, mass, 1.0)
    with np.errstate(over="ignore"):
        speed = np.sqrt((velocity.astype(np.float64) ** 2).sum(axis=0))
        acceleration = np.sqrt(((force.astype(np.float64) / m) ** 2).sum(axis=0))
    for row, value in enumerate((speed, acceleration)):
        value = np.where(move, np.where(np.isnan(value), np.inf, value), 0.0)
        for p in range(PIECES):
            motion_bounds[row, p] = value[p * n // PIECES : (p + 1) * n // PIECES].max(initial=0.0)
