"""Motion of nodes: what is given, what is driven, arrival, and what the choice of the next step needs. Slime spec 1, S14."""

import numpy as np

from melt.reference._period import boxed, nearest
from melt.reference._shares import shares


def keep_motion(position, velocity, position_kept, velocity_kept):
    """Write a copy of the motion at the start of a sub-step.

    Reads: position (3, n) [m], velocity (3, n) [m/s]. Writes: position_kept, velocity_kept.
    """
    position_kept[:], velocity_kept[:] = position, velocity


def restore_motion(position_kept, velocity_kept, position, velocity):
    """Write the motion at the start of the sub-step back, to try it again with a shorter one.

    Reads: position_kept (3, n) [m], velocity_kept (3, n) [m/s]. Writes: position, velocity.
    """
    position[:], velocity[:] = position_kept, velocity_kept


def drive(phase, driver, position, driver_motion, velocity):
    """Write V + Omega x r + k Omega x (Omega x r), r = x - c, of driven particles (phase 7) that belong to a moving body.

    With Omega and k of `melt.slime.motion` it is the chord of the turn of a sub-step: r keeps its length.

    Reads: phase (n,), driver (n,): the body or -1, position (3, n) [m], driver_motion (10, bodies): velocity [m/s],
        spin [1/s], centre [m], k [s]. Writes: velocity (3, n) [m/s], of those alone.
    """
    for i in np.flatnonzero((phase == 7) & (driver >= 0)):
        body = driver_motion[:, driver[i]].astype(np.float64)
        turn = np.cross(body[3:6], position[:, i].astype(np.float64) - body[6:9])
        velocity[:, i] = body[:3] + turn + body[9] * np.cross(body[3:6], turn)


def nozzle_hold(phase, position, nozzle_place, nozzle_speed, held, velocity):
    """Hold the liquid inside nozzles at their speed, along their direction; the first nozzle wins.

    Inside is: from the outlet back by the length, and within the radius of the axis, all included.
    Reads: phase (n,), position (3, n) [m], nozzle_place (8, nozzles): centre of the outlet, unit direction of the
        flow, length, radius [m]; nozzle_speed (nozzles,) [m/s].
    Writes: held (n,), 1 inside; velocity (3, n) [m/s] of those alone.
    """
    held[:] = 0
    for i in np.flatnonzero(phase == 0):
        for k in range(nozzle_speed.shape[0]):
            place = nozzle_place[:, k].astype(np.float64)
            d = position[:, i].astype(np.float64) - place[:3]
            t = d @ place[3:6]
            off = d - t * place[3:6]
            if -place[6] <= t <= 0 and off @ off <= place[7] ** 2:
                held[i] = 1
                velocity[:, i] = float(nozzle_speed[k]) * place[3:6]
                break


def weight(position, phase, mass, fluid, force):
    """Write m (g - B^2 x) of liquid and solid particles, 0 of all others; B^2 is ``fluid.central``.

    Reads: position (3, n) [m], phase (n,), mass (n,) [kg]. Writes: force (3, n) [N].
    """
    g = np.array([[fluid.gravity_x], [fluid.gravity_y], [fluid.gravity_z]], dtype=np.float64)
    force[:] = np.where((phase == 0) | (phase == 1), (g - float(fluid.central) * position) * mass.astype(np.float64), 0.0)


def free_kick(phase, mobility, force, dt, velocity):
    """Write v += dt F mobility of liquid and solid particles: held liquid and what has no mass keep their velocity.

    Reads: phase (n,), mobility (n,) [1/kg], force (3, n) [N], dt [s]. Writes: velocity (3, n) [m/s].
    """
    move = (phase == 0) | (phase == 1)
    velocity[:, move] += float(dt) * mobility[move].astype(np.float64) * force[:, move].astype(np.float64)


def _arrival(position_kept, velocity, dt):
    """Return where the particles arrive, in the precision of positions: (1.7) with the position at the start."""
    found = position_kept.astype(np.float64) + float(dt) * velocity.astype(np.float64)
    return found.astype(position_kept.dtype)


def advect(phase, position_kept, velocity, period, dt, position):
    """Write x = x_kept + dt v of liquid, solid and driven particles, moved into the periodic box.

    From the kept position, whatever the present one is: the sub-step may have been evaluated elsewhere (S14).
    Reads: phase (n,), position_kept (3, n) [m], velocity (3, n) [m/s], dt [s]. Writes: position (3, n) [m] of those.
    """
    move = (phase == 0) | (phase == 1) | (phase == 7)
    position[:, move] = boxed(_arrival(position_kept, velocity, dt)[:, move], period)


def slime_bounds(phase, velocity, apic_phase, apic_affine, position, position_kept, period, dt, slime_bounds):
    """Write 64 partial maxima of the speed of liquid, of |C| of active APIC particles, and of how far arrivals miss.

    A NaN counts as infinite, so that the host notices it. APIC particles may be none.
    Reads: phase (n,), velocity (3, n) [m/s], apic_phase (p,), apic_affine (9, p) [1/s], position and position_kept
        (3, n) [m], dt [s].
    Writes: slime_bounds (3, 64): |v|, the Frobenius norm of C, |x_kept + dt v - x| to the nearest image.
    """
    liquid = phase == 0
    v = velocity.astype(np.float64)
    apart = position_kept.astype(np.float64) - position.astype(np.float64)
    with np.errstate(invalid="ignore", over="ignore"):
        values = (
            np.where(liquid, (v**2).sum(axis=0), 0.0),
            np.where(apic_phase == 0, (apic_affine.astype(np.float64) ** 2).sum(axis=0), 0.0),
            np.where(liquid, (nearest(apart + float(dt) * v, period) ** 2).sum(axis=0), 0.0),
        )
    for row, value in enumerate(values):
        value = np.sqrt(np.where(np.isnan(value), np.inf, value))
        slime_bounds[row] = [s.max(initial=0.0) for s in shares(value)]


def arrival_correction(phase, velocity, position, position_kept, period, dt, velocity_correction):
    """Write v - (X_a - x^n)/dt: what the sub-step has changed since the arrival X_a was predicted; 0 of what stands still.

    The density at X_a already has what the predicted velocity brings: the density solve adds this alone (spec 2.12.5).
    Reads: phase (n,), velocity (3, n) [m/s], position X_a and position_kept x^n (3, n) [m], dt [s].
    Writes: velocity_correction (3, n) [m/s].
    """
    moves = np.isin(phase, (0, 1, 7))
    came = nearest(position.astype(np.float64) - position_kept, period) / float(dt)
    velocity_correction[:] = np.where(moves, velocity - came, 0.0)
