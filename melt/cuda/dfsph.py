"""CUDA twin of `melt.reference.dfsph`. Sums: one thread for each of 64 shares, added in order."""

import math

from melt._compile import cuda, cuda_kernel


@cuda_kernel
def _pressure_start(compression_source, dfsph_factor, density_impulse, dfsph, dt, solver_pressure):
    i = cuda.grid(1)
    if i >= compression_source.shape[0]:
        return
    real = type(dt)
    per_dt2 = real(1) / (dt * dt)
    source, factor = compression_source[i], dfsph_factor[i]
    start = min(dfsph.warm * density_impulse[i], dfsph.warm_limit * source * factor)
    solver_pressure[i] = start * per_dt2 if source > real(0) and factor > real(0) else real(0)


def pressure_start(compression_source, dfsph_factor, density_impulse, dfsph, dt, solver_pressure):
    """See `melt.reference.dfsph.pressure_start`."""
    _pressure_start.launch(
        compression_source.shape[0], compression_source, dfsph_factor, density_impulse, dfsph, dt, solver_pressure
    )


@cuda_kernel
def _pressure_acceleration(
    volume, mobility, solver_pressure, neighbour_count, neighbour_index, pair_gradient, pressure_acceleration,
):
    i = cuda.grid(1)
    if i >= volume.shape[0]:
        return
    real = volume.dtype.type
    x = y = z = real(0)
    if mobility[i] > real(0):
        p = solver_pressure[i]
        for k in range(min(neighbour_count[i], neighbour_index.shape[1])):
            both = p + solver_pressure[neighbour_index[i, k]]
            x += both * pair_gradient[0, i, k]
            y += both * pair_gradient[1, i, k]
            z += both * pair_gradient[2, i, k]
    c = -mobility[i] * volume[i]
    pressure_acceleration[0, i] = c * x
    pressure_acceleration[1, i] = c * y
    pressure_acceleration[2, i] = c * z


def pressure_acceleration(
    volume, mobility, solver_pressure, neighbour_count, neighbour_index, pair_gradient, pressure_acceleration,
):
    """See `melt.reference.dfsph.pressure_acceleration`."""
    _pressure_acceleration.launch(
        volume.shape[0], volume, mobility, solver_pressure, neighbour_count, neighbour_index, pair_gradient,
        pressure_acceleration,
    )


@cuda_kernel
def _pressure_update(
    pressure_acceleration, compression_source, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dfsph, dt,
    solver_pressure, compression_left,
):
    i = cuda.grid(1)
    if i >= dfsph_factor.shape[0]:
        return
    real = type(dt)
    # not: source > -1e5, which a NaN would fail
    if not dfsph_factor[i] > real(0) or compression_source[i] <= real(-1e5):
        solver_pressure[i] = compression_left[i] = real(0)
        return
    dt2 = dt * dt
    a, b, c = pressure_acceleration[0, i], pressure_acceleration[1, i], pressure_acceleration[2, i]
    change = real(0)
    for k in range(min(neighbour_count[i], neighbour_index.shape[1])):
        j = neighbour_index[i, k]
        change += (
            pair_gradient[0, i, k] * (a - pressure_acceleration[0, j])
            + pair_gradient[1, i, k] * (b - pressure_acceleration[1, j])
            + pair_gradient[2, i, k] * (c - pressure_acceleration[2, j])
        )
    r = compression_source[i] + dt2 * change
    p = solver_pressure[i] + dfsph.omega * r * dfsph_factor[i] / dt2
    solver_pressure[i] = real(0) if p <= real(0) else p
    # a NaN would lose every comparison that follows; infinity wins them
    compression_left[i] = max(r, real(0)) if r == r else real(math.inf)


@cuda_kernel
def _pressure_error(compression_source, dfsph_factor, compression_left, pressure_error):
    share = cuda.grid(1)
    if share >= 64:
        return
    real = dfsph_factor.dtype.type
    double = pressure_error.dtype.type
    n = dfsph_factor.shape[0]
    total = largest = number = double(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        if dfsph_factor[i] > real(0) and not compression_source[i] <= real(-1e5):
            left = double(compression_left[i])
            total += left
            largest = max(largest, left)
            number += double(1)
    pressure_error[0, share], pressure_error[1, share], pressure_error[2, share] = total, largest, number


def pressure_update(
    pressure_acceleration, compression_source, dfsph_factor, neighbour_count, neighbour_index, pair_gradient, dfsph, dt,
    solver_pressure, compression_left, pressure_error,
):
    """See `melt.reference.dfsph.pressure_update`."""
    _pressure_update.launch(
        dfsph_factor.shape[0], pressure_acceleration, compression_source, dfsph_factor, neighbour_count, neighbour_index,
        pair_gradient, dfsph, dt, solver_pressure, compression_left,
    )
    _pressure_error.launch(64, compression_source, dfsph_factor, compression_left, pressure_error)


@cuda_kernel
def _pressure_extrapolate(momentum, solver_pressure, pressure_last):
    i = cuda.grid(1)
    if i >= solver_pressure.shape[0]:
        return
    real = type(momentum)
    p = solver_pressure[i]
    ahead = p + momentum * (p - pressure_last[i]) if momentum > real(0) else p
    solver_pressure[i] = real(0) if ahead <= real(0) else ahead  # a NaN stays
    pressure_last[i] = p


def pressure_extrapolate(momentum, solver_pressure, pressure_last):
    """See `melt.reference.dfsph.pressure_extrapolate`."""
    _pressure_extrapolate.launch(solver_pressure.shape[0], momentum, solver_pressure, pressure_last)


@cuda_kernel
def _pressure_kick(pressure_acceleration, dt, velocity):
    i = cuda.grid(1)
    if i >= velocity.shape[1]:
        return
    velocity[0, i] += dt * pressure_acceleration[0, i]
    velocity[1, i] += dt * pressure_acceleration[1, i]
    velocity[2, i] += dt * pressure_acceleration[2, i]


def pressure_kick(pressure_acceleration, dt, velocity):
    """See `melt.reference.dfsph.pressure_kick`."""
    _pressure_kick.launch(velocity.shape[1], pressure_acceleration, dt, velocity)


@cuda_kernel
def _pressure_keep(solver_pressure, dt, density_impulse):
    i = cuda.grid(1)
    if i >= solver_pressure.shape[0]:
        return
    density_impulse[i] = solver_pressure[i] * (dt * dt)


def pressure_keep(solver_pressure, dt, density_impulse):
    """See `melt.reference.dfsph.pressure_keep`."""
    _pressure_keep.launch(solver_pressure.shape[0], solver_pressure, dt, density_impulse)
