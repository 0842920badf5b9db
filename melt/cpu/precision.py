"""CPU twin of `melt.reference.precision`."""

import math

import numpy as np

from melt._compile import cpu_serial, cpu_stage, prange
from melt.physics.phases import LIQUID
from melt.physics.precision import iterations_of, target_precision
from melt.physics.search import axis_cell


@cpu_serial
def height_histogram(position, phase, pbf, height_bins):
    """See `melt.reference.precision.height_histogram`."""
    bins = np.int32(height_bins.shape[0])
    for b in range(bins):
        height_bins[b] = 0
    for i in range(phase.shape[0]):
        if phase[i] == LIQUID:
            height_bins[axis_cell(position[2, i], pbf.floor, pbf.inverse_bin, bins)] += 1


@cpu_stage
def momentum_size(phase, mass, velocity, momentum_size):
    """See `melt.reference.precision.momentum_size`."""
    real = mass.dtype.type
    for i in prange(phase.shape[0]):
        u, v, w = velocity[0, i], velocity[1, i], velocity[2, i]
        momentum_size[i] = mass[i] * math.sqrt(u * u + v * v + w * w) if phase[i] == LIQUID else real(0)


@cpu_stage
def effect_precision(
    position, phase, momentum_size, neighbour_count, neighbour_index, pbf, height, dt,
    effect_precision, support_radius, iterations,
):
    """See `melt.reference.precision.effect_precision`."""
    real = type(pbf.support)
    wide = position.dtype.type
    for i in prange(phase.shape[0]):
        if phase[i] != LIQUID:
            effect_precision[i] = support_radius[i] = real(0)
            iterations[i] = 0
            continue
        own = momentum_size[i]
        most = own
        for k in range(np.uint64(neighbour_count[i])):
            most = max(most, momentum_size[np.uint64(neighbour_index[i, k])])
        y = real(position[2, i] - wide(pbf.floor))
        target = target_precision(y, height, own, most, pbf)
        F = effect_precision[i]
        F += (target - F) * min(real(1), dt / pbf.precision_time)
        F = min(max(F, pbf.minimum_precision), real(1))
        effect_precision[i] = F
        support_radius[i] = max(F * pbf.support, pbf.minimum_support)
        iterations[i] = iterations_of(F, pbf)


@cpu_stage
def iteration_key(phase, iterations, neighbour_count, neighbour_index, pbf, iteration_key):
    """See `melt.reference.precision.iteration_key`."""
    for i in prange(phase.shape[0]):
        key = np.int32(0)
        if phase[i] == LIQUID and pbf.same_iterations == 1:
            key = pbf.iterations
        elif phase[i] == LIQUID:
            key = iterations[i]
            for k in range(np.uint64(neighbour_count[i])):
                key = max(key, iterations[np.uint64(neighbour_index[i, k])])
        iteration_key[i] = key


@cpu_serial
def active_list(iteration_key, iteration, active_index, active_count, chunk_sum):
    """See `melt.reference.precision.active_list`; `chunk_sum` is used by the CUDA twin only."""
    count = np.uint64(0)
    for i in range(np.uint64(iteration_key.shape[0])):
        if iteration_key[i] > iteration:
            active_index[count] = np.int32(i)
            count += np.uint64(1)
    active_count[0] = np.int32(count)
