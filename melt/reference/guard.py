"""Non-penetration guard of liquid against solids and walls. Melting spec 2.4."""

import numpy as np

from melt.reference._pairs import separations


def _pairs(position, phase, guard):
    x_ij, r = separations(position)
    liquid, solid, wall = (phase == p for p in range(3))
    opposite = liquid[:, None] & (solid | wall)[None, :] | solid[:, None] & liquid[None, :]
    return x_ij, r, opposite & (r < float(guard.distance))


def guard_offenders(position, phase, neighbour_count, neighbour_index, guard, offenders):
    """Write how many partners are closer than d_min: solids and walls of a liquid, liquid of a solid.

    Reads: position (3, n) [m], phase (n,); all pairs. Writes: offenders (n,); 0 for walls.
    """
    offenders[:] = _pairs(position, phase, guard)[2].sum(axis=1)


def guard_correction(
    position, velocity, phase, mass, offenders, neighbour_count, neighbour_index, guard,
    position_next, velocity_next,
):
    r"""Push offending pairs apart and take away their approach: one Jacobi pass.

    .. math::
        x'_i = x_i + \sum_k w_{ik} \frac{\bar m}{m_i} (d_{min} - r) n, \quad
        v'_i = v_i - \sum_k w_{ik} \frac{\bar m}{m_i} \min(v_{ik} \cdot n, 0) n

    n = x_ik/r, m-bar the reduced mass (m_i against a wall, which is infinitely heavy), and the
    symmetric weight w = 1/max(n_i, n_k) of the offender counts (1/n_i against a wall): linear
    momentum is exact. Coincident particles have no normal: they are counted, and left.
    Reads: position (3, n) [m], velocity (3, n) [m/s], phase (n,), mass (n,) [kg], offenders (n,).
    Writes: position_next (3, n) [m], velocity_next (3, n) [m/s] of all particles.
    """
    x_ij, r, pair = _pairs(position, phase, guard)
    v = np.asarray(velocity, dtype=np.float64)
    m = np.asarray(mass, dtype=np.float64)
    pair = pair & (r >= 1e-9 * float(guard.distance))
    n = x_ij / np.where(pair, r, 1.0)
    wall = (phase == 2)[None, :]
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(wall, 1.0, m[None, :] / (m[:, None] + m[None, :]))  # m-bar / m_i
    most = np.where(wall, offenders[:, None], np.maximum(offenders[:, None], offenders[None, :]))
    w = np.where(pair, share / np.maximum(most, 1), 0.0)
    v_n = ((v[:, :, None] - v[:, None, :]) * n).sum(axis=0)
    x = np.asarray(position, dtype=np.float64)
    position_next[:] = x + (w * (float(guard.distance) - r) * n).sum(axis=2)
    velocity_next[:] = v - (w * np.minimum(v_n, 0.0) * n).sum(axis=2)
