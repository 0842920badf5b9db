r"""Vapour above the surface as SPH smoke. Boiling spec 2.6, eq (16); Mueller, Charypar, Gross 2003 (M03).

RECONSTRUCTED: the paper only names SPH vapour with an effect precision of its own. Taken from M03 are density and
the symmetric pressure force, with poly6 W, spiky grad W and :math:`R_{ij} = (R_i + R_j)/2`:

.. math::
    \rho_i = \sum_j m W_{ij}, \quad p = k_v \max(\rho - \rho_{v0}, 0), \quad
    f_i = -\sum_j m \frac{p_i + p_j}{2 \rho_j} \nabla W_{ij}, \quad
    a_i = \frac{f_i}{\rho_i} - g \beta_v (T_i - T_{air})

Chosen here: buoyancy linear in the temperature, drag in still air (implicit, rate 1/s), a finite life, birth in a
ball around the top of a burst bubble, and the split of (16) between density and pressure,

.. math:: F_i = a_S \frac{\rho_i}{\max \rho} + b_S \frac{P_i}{\max P}, \quad P_i = |f_i|, \quad R'_i = \max(F_i R', R'_{min})
"""

import numpy as np

from melt.reference._pairs import separations
from melt.reference._pbf import listed
from melt.reference._philox import ball_offset


def vapour_source(
    burst_index, burst_top, free_index, vapour, boiling, step_low, step_high, first_id, served,
    phase, id, position, velocity, mass, rest_volume, temperature, age, vapour_support,
):
    """Set vapour particles free where bubbles burst, at rest and as warm as boiling water.

    Number a comes from burst a // per_burst of the list and takes slot a of the free ones. It starts at the height
    of the surface above the bubble or up to ``spread`` higher, within that distance of the bubble's axis.

    Reads: burst_index (n,), burst_top (n,) [m] of bursting bubbles, free_index (n,), the first ``served`` of which
        are used; position of bubbles [m].
    Writes: of those slots, phase, id, position (3, n) [m], velocity (3, n) [m/s], mass [kg], rest_volume [m^3] (0:
        vapour displaces nothing), temperature [degC], age [s], vapour_support [m]; others keep theirs.
    """
    for a in range(int(served)):
        b, i = burst_index[a // int(vapour.per_burst)], free_index[a]
        offset = ball_offset(first_id + a, step_low, step_high, boiling.seed_low, boiling.seed_high, 3)
        away = float(vapour.spread) * np.array(offset)
        position[:2, i] = position[:2, b].astype(np.float64) + away[:2]
        position[2, i] = float(burst_top[b]) + abs(away[2])  # not below the surface
        phase[i], id[i] = 4, first_id + a
        velocity[:, i], rest_volume[i], age[i] = 0, 0, 0
        mass[i], temperature[i], vapour_support[i] = vapour.mass, boiling.boiling_point, vapour.support


def _pairs(position, phase, vapour_support, neighbour_count, neighbour_index):
    """Return x_ij (3, n, n), r_ij, R_ij (1 for pairs that do not count), and which pairs are of vapour in the lists."""
    x_ij, r = separations(position)
    R = vapour_support.astype(np.float64)
    on = (phase == 4)[:, None] & (phase == 4)[None, :] & listed(neighbour_count, neighbour_index)
    return x_ij, r, np.where(on, (R[:, None] + R[None, :]) / 2, 1.0), on


def vapour_density(
    position, phase, vapour_support, neighbour_count, neighbour_index, vapour, vapour_density, vapour_pressure,
):
    """Write SPH density and pressure of vapour.

    Reads: position (3, n) [m], phase (n,), vapour_support (n,) [m], neighbour lists.
    Writes: vapour_density (n,) [kg/m^3], vapour_pressure (n,) [Pa] of vapour; others keep theirs.
    """
    _, r, R, on = _pairs(position, phase, vapour_support, neighbour_count, neighbour_index)
    W1 = np.where(on, 315 / (64 * np.pi * R**9) * np.where(r < R, R**2 - r**2, 0.0) ** 3, 0.0)
    rho, which = float(vapour.mass) * W1.sum(axis=1), phase == 4
    vapour_density[which] = rho[which]
    vapour_pressure[which] = float(vapour.stiffness) * np.maximum(rho - float(vapour.rest_density), 0.0)[which]


def vapour_force(
    position, phase, temperature, vapour_density, vapour_pressure, vapour_support, neighbour_count, neighbour_index,
    vapour, dt, velocity, vapour_push,
):
    """Accelerate vapour by pressure and buoyancy and slow it down in still air, v := (v + dt a)/(1 + drag dt).

    The pressure conserves momentum: m f_i/rho_i of a pair is antisymmetric.

    Reads: position (3, n) [m], phase (n,), temperature (n,) [degC], vapour_density (n,) [kg/m^3], vapour_pressure
        (n,) [Pa], vapour_support (n,) [m], neighbour lists.
    Writes: velocity (3, n) [m/s], vapour_push (n,) = P_i [N/m^3] of vapour; others keep theirs.
    """
    x_ij, r, R, on = _pairs(position, phase, vapour_support, neighbour_count, neighbour_index)
    apart = on & (r > 1e-9 * float(vapour.support))
    size = np.where(apart, 45 / (np.pi * R**6) * np.where(r < R, R - r, 0.0) ** 2 / np.where(apart, r, 1.0), 0.0)
    gradW2 = -size * x_ij
    which, dt = phase == 4, float(dt)
    rho = np.where(which, vapour_density, 1.0).astype(np.float64)
    p = np.where(which, vapour_pressure, 0.0).astype(np.float64)
    f = -(float(vapour.mass) * (p[:, None] + p[None, :]) / (2 * rho[None, :]) * gradW2).sum(axis=2)
    warm = np.where(which, temperature, 0.0).astype(np.float64) - float(vapour.air_temperature)
    buoyancy = np.array([[vapour.buoyancy_x], [vapour.buoyancy_y], [vapour.buoyancy_z]], dtype=np.float64)
    v = (velocity.astype(np.float64) + dt * (f / rho + buoyancy * warm)) / (1 + float(vapour.drag) * dt)
    velocity[:, which] = v[:, which]
    vapour_push[which] = np.sqrt((f**2).sum(axis=0))[which]


def vapour_move(velocity, bubbles, vapour, dt, phase, position, age):
    """Move vapour by dt, within the walls, and take away what is older than its life.

    Reads: velocity (3, n) [m/s].
    Writes: of vapour, phase (n,) (inactive at the end), position (3, n) [m], age (n,) [s]; others keep theirs.
    """
    on, dt = phase == 4, float(dt)
    lower = np.array([[bubbles.lower_x], [bubbles.lower_y], [bubbles.lower_z]], dtype=np.float64)
    upper = np.array([[bubbles.upper_x], [bubbles.upper_y], [bubbles.upper_z]], dtype=np.float64)
    position[:, on] = np.clip(position[:, on].astype(np.float64) + dt * velocity[:, on].astype(np.float64), lower, upper)
    age[on] += age.dtype.type(dt)
    phase[on & (age > vapour.life)] = 5


def vapour_precision(phase, vapour_density, vapour_push, neighbour_count, neighbour_index, vapour, vapour_support):
    """Write the support radius of vapour for the next step, eq (16); R' for all without adaptation.

    The maxima are over the vapour in the list and itself; where they are 0 the term counts in full.

    Reads: phase (n,), vapour_density (n,) [kg/m^3], vapour_push (n,) [N/m^3], neighbour lists.
    Writes: vapour_support (n,) [m] of vapour; others keep theirs.
    """
    R, a_S = float(vapour.support), float(vapour.density_share)
    rho, P = vapour_density.astype(np.float64), vapour_push.astype(np.float64)
    for i in np.flatnonzero(phase == 4):
        near = neighbour_index[i, : neighbour_count[i]]
        near = np.append(near[phase[near] == 4], i)
        most_rho, most_P = rho[near].max(), P[near].max()
        F = a_S * (rho[i] / most_rho if most_rho > 0 else 1.0) + (1 - a_S) * (P[i] / most_P if most_P > 0 else 1.0)
        vapour_support[i] = max(F * R, float(vapour.minimum_support)) if vapour.adapt == 1 else R  # (16)
