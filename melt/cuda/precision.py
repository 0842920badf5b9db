"""CUDA twin of `melt.reference.precision`."""

import math

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.cuda._scan import CHUNK, _scan_sums, chunks
from melt.physics.phases import LIQUID
from melt.physics.precision import iterations_of, target_precision
from melt.physics.search import axis_cell


@cuda_kernel
def _clear(values):
    k = cuda.grid(1)
    if k < values.shape[0]:
        values[k] = 0


@cuda_kernel
def _height_histogram(position, phase, pbf, height_bins):
    i = cuda.grid(1)
    if i < phase.shape[0] and phase[i] == LIQUID:
        b = axis_cell(position[2, i], pbf.floor, pbf.inverse_bin, height_bins.shape[0])
        cuda.atomic.add(height_bins, b, 1)  # integers: any order gives the same


def height_histogram(position, phase, pbf, height_bins):
    """See `melt.reference.precision.height_histogram`."""
    _clear.launch(height_bins.shape[0], height_bins)
    _height_histogram.launch(phase.shape[0], position, phase, pbf, height_bins)


@cuda_kernel
def _momentum_size(phase, mass, velocity, momentum_size):
    i = cuda.grid(1)
    if i < phase.shape[0]:
        u, v, w = velocity[0, i], velocity[1, i], velocity[2, i]
        real = mass.dtype.type
        momentum_size[i] = mass[i] * math.sqrt(u * u + v * v + w * w) if phase[i] == LIQUID else real(0)


def momentum_size(phase, mass, velocity, momentum_size):
    """See `melt.reference.precision.momentum_size`."""
    _momentum_size.launch(phase.shape[0], phase, mass, velocity, momentum_size)


@cuda_kernel
def _effect_precision(
    position, phase, momentum_size, neighbour_count, neighbour_index, pbf, height, dt,
    effect_precision, support_radius, iterations,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(pbf.support)
    wide = position.dtype.type
    if phase[i] != LIQUID:
        effect_precision[i] = support_radius[i] = real(0)
        iterations[i] = 0
        return
    own = momentum_size[i]
    most = own
    for k in range(neighbour_count[i]):
        most = max(most, momentum_size[neighbour_index[i, k]])
    y = real(position[2, i] - wide(pbf.floor))
    target = target_precision(y, height, own, most, pbf)
    F = effect_precision[i]
    F += (target - F) * min(real(1), dt / pbf.precision_time)
    F = min(max(F, pbf.minimum_precision), real(1))
    effect_precision[i] = F
    support_radius[i] = max(F * pbf.support, pbf.minimum_support)
    iterations[i] = iterations_of(F, pbf)


def effect_precision(
    position, phase, momentum_size, neighbour_count, neighbour_index, pbf, height, dt,
    effect_precision, support_radius, iterations,
):
    """See `melt.reference.precision.effect_precision`."""
    _effect_precision.launch(
        phase.shape[0], position, phase, momentum_size, neighbour_count, neighbour_index, pbf,
        height, dt, effect_precision, support_radius, iterations,
    )


@cuda_kernel
def _iteration_key(phase, iterations, neighbour_count, neighbour_index, pbf, iteration_key):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    key = np.int32(0)
    if phase[i] == LIQUID and pbf.same_iterations == 1:
        key = pbf.iterations
    elif phase[i] == LIQUID:
        key = iterations[i]
        for k in range(neighbour_count[i]):
            key = max(key, iterations[neighbour_index[i, k]])
    iteration_key[i] = key


def iteration_key(phase, iterations, neighbour_count, neighbour_index, pbf, iteration_key):
    """See `melt.reference.precision.iteration_key`."""
    _iteration_key.launch(
        phase.shape[0], phase, iterations, neighbour_count, neighbour_index, pbf, iteration_key,
    )


@cuda_kernel
def _count_active(iteration_key, iteration, chunk_sum):
    c = cuda.grid(1)
    first = c * CHUNK
    if first >= iteration_key.shape[0]:
        return
    total = 0
    for i in range(first, min(first + CHUNK, iteration_key.shape[0])):
        if iteration_key[i] > iteration:
            total += 1
    chunk_sum[c] = total


@cuda_kernel
def _place_active(iteration_key, iteration, chunk_sum, active_index, active_count):
    c = cuda.grid(1)
    first = c * CHUNK
    if first >= iteration_key.shape[0]:
        return
    place = chunk_sum[c]
    for i in range(first, min(first + CHUNK, iteration_key.shape[0])):
        if iteration_key[i] > iteration:
            active_index[place] = i
            place += 1
    if first + CHUNK >= iteration_key.shape[0]:
        active_count[0] = place


def active_list(iteration_key, iteration, active_index, active_count, chunk_sum):
    """See `melt.reference.precision.active_list`.

    The length stays on the device: stages on the list launch a thread per particle, and whole warps behind its
    end leave at once, which costs less than the wait of a read-back.
    """
    n = chunks(iteration_key.shape[0])
    _clear.launch(1, active_count)
    _count_active.launch(n, iteration_key, iteration, chunk_sum)
    _scan_sums.launch(min(n, 1), n, chunk_sum)
    _place_active.launch(n, iteration_key, iteration, chunk_sum, active_index, active_count)
