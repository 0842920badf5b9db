r"""Prediction, position update and velocity of the position based fluid and the solids in it. Boiling spec 1 (S2, S4c, S5)."""

import numpy as np


def _box(vessel):
    sides = np.array([[vessel.lower_x, vessel.upper_x], [vessel.lower_y, vessel.upper_y], [vessel.lower_z, vessel.upper_z]])
    return sides[:, :1].astype(np.float64), sides[:, 1:].astype(np.float64)


def pbf_predict(phase, fluid, pbf, vessel, dt, velocity, position, position_predicted):
    r"""Predict liquid and solids: v += dt g, :math:`|v| \le d/(2 dt)`, x += dt v.

    Reads: phase (n,), velocity (3, n) [m/s], position (3, n) [m].
    Writes: velocity and position of both, this one clamped to the vessel; position_predicted (3, n) as it was
        before, the position of all others.
    """
    on = phase <= 1
    g = np.array([[fluid.gravity_x], [fluid.gravity_y], [fluid.gravity_z]], dtype=np.float64)
    dt = float(dt)
    v = velocity[:, on].astype(np.float64) + dt * g
    speed, most = np.sqrt((v**2).sum(axis=0)), 0.5 * float(pbf.spacing) / dt
    v *= np.where(speed > most, most / np.where(speed > most, speed, 1.0), 1.0)
    velocity[:, on] = v
    position_predicted[:] = position
    x = position[:, on].astype(np.float64) + dt * v
    position_predicted[:, on] = x
    position[:, on] = np.clip(x, *_box(vessel))


def pbf_move(correction, active_index, active_count, pbf, vessel, position):
    """Add the corrections of the listed particles to their positions, clamped to the vessel.

    One is half a spacing long at most: liquid far denser than at rest (a thousand particles at one point) would
    else be thrown by metres.

    Reads: correction (3, n) [m], active_index (n,) of which the first active_count[0] count.
    Writes: position (3, n) [m] of the listed.
    """
    on = active_index[: int(active_count[0])]
    lower, upper = _box(vessel)
    moved, most = correction[:, on].astype(np.float64), 0.5 * float(pbf.spacing)
    size = np.sqrt((moved**2).sum(axis=0))
    moved *= np.where(size > most, most / np.where(size > most, size, 1.0), 1.0)
    position[:, on] = np.clip(position[:, on].astype(np.float64) + moved, lower, upper)


def pbf_velocity(position, position_predicted, phase, dt, velocity):
    """Add to the velocity [m/s] of liquid and solids what solve, vessel and shape matching moved them by, (x - x_predicted)/dt.

    The same as (x - x^n)/dt, but without its rounding: a particle on its own keeps v + dt g to the last bit,
    where the difference of float32 positions at 1 m is off by 6e-8 m/dt.

    Reads: position, position_predicted (3, n) [m], phase (n,). Writes: velocity (3, n); others keep theirs.
    """
    on = phase <= 1
    moved = position[:, on].astype(np.float64) - position_predicted[:, on].astype(np.float64)
    velocity[:, on] = velocity[:, on].astype(np.float64) + moved / float(dt)


def pbf_bounds(phase, velocity, constraint, pbf_bounds):
    """Write the largest speed [m/s] and density constraint of liquid and solids in each of the pieces.

    Reads: phase (n,), velocity (3, n) [m/s], constraint (n,).
    Writes: pbf_bounds (2, pieces): piece p covers the particles from p n/pieces on; 0 where it has none.
    """
    n, pieces = phase.shape[0], pbf_bounds.shape[1]
    speed = np.sqrt((velocity.astype(np.float64) ** 2).sum(axis=0))
    for p in range(pieces):
        part = slice(p * n // pieces, (p + 1) * n // pieces)
        on = phase[part] <= 1
        for row, values in enumerate((speed[part][on], constraint[part][on].astype(np.float64))):
            pbf_bounds[row, p] = max(0.0, np.where(np.isnan(values), np.inf, values).max(initial=0.0))
