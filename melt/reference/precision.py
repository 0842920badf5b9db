r"""Effect precision: how far and how often each particle takes part in the solve. Boiling eq (15), spec 2.6.

.. math:: F_i = 1 \text{ if } y_i \ge H, \text{ else } a_F \frac{y_i}{H} + b_F \frac{E_i}{\max_j E_j},
    \quad R_i = \max(F_i R, R_{min}), \quad J_i = \mathrm{clamp}(\lceil F_i J \rceil, J_{min}, J)

with y the height above the floor, E = m |v|, the maximum over neighbours and itself.
"""

import numpy as np


def height_histogram(position, phase, pbf, height_bins):
    """Write how many liquid particles are in each bin of height above the floor; the outer bins take the rest.

    Reads: position (3, n) [m], phase (n,). Writes: height_bins (bins,).
    """
    bins = height_bins.shape[0]
    y = position[2, phase == 0].astype(np.float64) - float(pbf.floor)
    k = np.clip(np.nan_to_num(y * float(pbf.inverse_bin)), 0, bins - 1).astype(np.int64)
    height_bins[:] = np.bincount(k, minlength=bins)


def momentum_size(phase, mass, velocity, momentum_size):
    """Write E = m |v| of liquid particles [kg m/s], 0 for others.

    Reads: phase (n,), mass (n,) [kg], velocity (3, n) [m/s]. Writes: momentum_size (n,).
    """
    E = mass.astype(np.float64) * np.sqrt((velocity.astype(np.float64) ** 2).sum(axis=0))
    momentum_size[:] = np.where(phase == 0, E, 0.0)


def effect_precision(
    position, phase, momentum_size, neighbour_count, neighbour_index, pbf, height, dt,
    effect_precision, support_radius, iterations,
):
    """Write effect precision, support radius and iterations of liquid particles for the next step.

    F follows its target with a time constant and stays within F_min and 1.

    Reads: position (3, n) [m], phase (n,), momentum_size (n,) [kg m/s], neighbour lists,
        effect_precision (n,) of the step before; height H [m] of what counts as surface.
    Writes: effect_precision (n,), support_radius (n,) [m], iterations (n,); others than liquid have 0.
    """
    E = momentum_size.astype(np.float64)
    height = float(height)
    for i in range(phase.shape[0]):
        if phase[i] != 0:
            effect_precision[i], support_radius[i], iterations[i] = 0, 0, 0
            continue
        near = neighbour_index[i, : neighbour_count[i]]
        most = max(E[i], E[near].max(initial=0.0))
        y = float(position[2, i]) - float(pbf.floor)
        a = float(pbf.height_share)
        if y >= height:
            target = 1.0
        else:
            target = a * max(y, 0.0) / height + (1 - a) * (E[i] / most if most > 0 else 0.0)  # (15)
        F = float(effect_precision[i])
        F += (target - F) * min(1.0, float(dt) / float(pbf.precision_time))
        F = min(max(F, float(pbf.minimum_precision)), 1.0)
        effect_precision[i] = F
        support_radius[i] = max(F * float(pbf.support), float(pbf.minimum_support))
        iterations[i] = min(max(int(np.ceil(F * int(pbf.iterations))), int(pbf.minimum_iterations)), int(pbf.iterations))


def iteration_key(phase, iterations, neighbour_count, neighbour_index, pbf, iteration_key):
    """Write the largest number of iterations of each liquid particle and its neighbours; 0 for others.

    Reads: phase (n,), iterations (n,) (effect precision only), neighbour lists. Writes: iteration_key (n,).
    """
    for i in range(phase.shape[0]):
        if phase[i] != 0:
            iteration_key[i] = 0
        elif pbf.same_iterations == 1:
            iteration_key[i] = pbf.iterations
        else:
            iteration_key[i] = max(iterations[i], iterations[neighbour_index[i, : neighbour_count[i]]].max(initial=0))


def active_list(iteration_key, iteration, active_index, active_count, chunk_sum):
    """Write the particles whose key exceeds the iteration, ascending, and how many they are.

    Reads: iteration_key (n,). Writes: active_index (n,), of which the first active_count[0] count.
    """
    on = np.flatnonzero(iteration_key > iteration)
    active_index[: on.size] = on
    active_count[0] = on.size
