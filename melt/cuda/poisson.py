"""CUDA twin of `melt.reference.poisson`. Sums in float64: one thread for each of 64 shares, added in order."""

from melt._compile import cuda, cuda_kernel
from melt.cuda._poisson import dot
from melt.physics.period import wrap
from melt.physics.poisson import poisson_entry, present_volume, wall_rise


@cuda_kernel
def _poisson_pairs(
    position, volume, completed_ratio, ghost_laplacian, dfsph_factor, neighbour_count, neighbour_index,
    smoothing, poisson, period, pair_poisson, poisson_ghost, poisson_diagonal,
):
    i = cuda.grid(1)
    if i >= volume.shape[0]:
        return
    real = type(smoothing.support)
    if not dfsph_factor[i] > real(0):
        for k in range(neighbour_count[i]):
            pair_poisson[i, k] = real(0)
        poisson_ghost[i] = real(0)
        poisson_diagonal[i] = real(0)
        return
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    V_i = present_volume(volume[i], completed_ratio[i])
    total = around = real(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x = real(wrap(x_i - position[0, j], period.length_x, period.inverse_x))
        y = real(wrap(y_i - position[1, j], period.length_y, period.inverse_y))
        z = real(wrap(z_i - position[2, j], period.length_z, period.inverse_z))
        V_j = present_volume(volume[j], completed_ratio[j])
        s = poisson_entry(V_i, V_j, x * x + y * y + z * z, smoothing, poisson)
        around += s
        s = s if dfsph_factor[j] > real(0) else real(0)
        pair_poisson[i, k] = s
        total += s
    ghosts = ghost_laplacian.shape[0] > 0
    given = ghost_laplacian[i] if ghosts else real(0)
    lack = max((real(0.5) if ghosts else real(1)) * poisson.full - around / (real(2) * V_i), real(0))
    ghost = real(4) * V_i * (given if given > real(0) else lack)
    poisson_ghost[i] = ghost
    poisson_diagonal[i] = total + ghost


def poisson_pairs(
    position, volume, completed_ratio, ghost_laplacian, dfsph_factor, neighbour_count, neighbour_index,
    smoothing, poisson, period, pair_poisson, poisson_ghost, poisson_diagonal,
):
    """See `melt.reference.poisson.poisson_pairs`."""
    _poisson_pairs.launch(
        volume.shape[0], position, volume, completed_ratio, ghost_laplacian, dfsph_factor, neighbour_count,
        neighbour_index, smoothing, poisson, period, pair_poisson, poisson_ghost, poisson_diagonal,
    )


@cuda_kernel
def _poisson_right(
    velocity, volume, completed_ratio, poisson_ghost, poisson_diagonal, surface_pressure, neighbour_count, neighbour_index,
    pair_gradient, poisson, dt, shift, poisson_residual,
):
    i = cuda.grid(1)
    if i >= volume.shape[0]:
        return
    real = type(dt)
    if not poisson_diagonal[i] > real(0):
        poisson_residual[i] = real(0)
        return
    u_i, v_i, w_i = velocity[0, i], velocity[1, i], velocity[2, i]
    rate = real(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        mirror = real(1) if poisson_diagonal[j] > real(0) else real(2)
        rate += mirror * (
            pair_gradient[0, i, k] * (u_i - velocity[0, j])
            + pair_gradient[1, i, k] * (v_i - velocity[1, j])
            + pair_gradient[2, i, k] * (w_i - velocity[2, j])
        )
    s = max(completed_ratio[i], real(0.5))
    lack = poisson.pull * min(real(0), s - real(1)) / dt
    b = present_volume(volume[i], s) * poisson.rest_density * ((rate / s + lack) / dt) - shift
    if surface_pressure.shape[0] > 0:
        b += poisson_ghost[i] * surface_pressure[i]
    poisson_residual[i] = b


@cuda_kernel
def _poisson_start(
    poisson_ghost, poisson_diagonal, neighbour_count, neighbour_index, pair_poisson, poisson_pressure,
    poisson_residual, poisson_direction,
):
    i = cuda.grid(1)
    if i >= poisson_diagonal.shape[0]:
        return
    real = poisson_residual.dtype.type
    if not poisson_diagonal[i] > real(0):
        poisson_direction[i] = real(0)
        return
    p_i, total = poisson_pressure[i], real(0)
    for k in range(neighbour_count[i]):
        total += pair_poisson[i, k] * (p_i - poisson_pressure[neighbour_index[i, k]])
    r = poisson_residual[i] - (total + poisson_ghost[i] * p_i)
    poisson_residual[i] = r
    poisson_direction[i] = r / poisson_diagonal[i]


@cuda_kernel
def _left(poisson_residual, poisson_diagonal, poisson_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    n = poisson_residual.shape[0]
    wide = poisson_sums.dtype.type
    left = number = wide(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        left += wide(poisson_residual[i])
        number += wide(1) if poisson_diagonal[i] > poisson_diagonal.dtype.type(0) else wide(0)
    poisson_sums[1, share], poisson_sums[2, share] = left, number


def poisson_start(
    velocity, volume, completed_ratio, poisson_ghost, poisson_diagonal, neighbour_count, neighbour_index,
    pair_gradient, pair_poisson, poisson_pressure, surface_pressure, poisson, dt, shift, poisson_residual, poisson_direction, poisson_sums,
):
    """See `melt.reference.poisson.poisson_start`. The residual holds b until b.b is known."""
    n = volume.shape[0]
    _poisson_right.launch(
        n, velocity, volume, completed_ratio, poisson_ghost, poisson_diagonal, surface_pressure, neighbour_count,
        neighbour_index, pair_gradient, poisson, dt, shift, poisson_residual,
    )
    dot.launch(64, poisson_residual, poisson_residual, 4, poisson_sums)
    _poisson_start.launch(
        n, poisson_ghost, poisson_diagonal, neighbour_count, neighbour_index, pair_poisson, poisson_pressure,
        poisson_residual, poisson_direction,
    )
    dot.launch(64, poisson_residual, poisson_direction, 0, poisson_sums)
    dot.launch(64, poisson_residual, poisson_residual, 3, poisson_sums)
    _left.launch(64, poisson_residual, poisson_diagonal, poisson_sums)


@cuda_kernel
def _poisson_acceleration(
    position, velocity, velocity_kept, volume, mobility, poisson_diagonal, solver_pressure, surface_pressure, neighbour_count,
    neighbour_index, pair_gradient, poisson, fluid, period, dt, pressure_acceleration,
):
    i = cuda.grid(1)
    if i >= volume.shape[0]:
        return
    real = volume.dtype.type
    per_dt = real(1) / dt
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    x = y = z = real(0)
    if mobility[i] > real(0):
        p = solver_pressure[i]
        twice = real(2) * surface_pressure[i] if surface_pressure.shape[0] > 0 else real(0)
        for k in range(neighbour_count[i]):
            j = neighbour_index[i, k]
            # what water that moves with the wall would add between here and there
            below = wall_rise(
                real(wrap(position[0, j] - x_i, period.length_x, period.inverse_x)),
                real(wrap(position[1, j] - y_i, period.length_y, period.inverse_y)),
                real(wrap(position[2, j] - z_i, period.length_z, period.inverse_z)),
                fluid.gravity_x - per_dt * (velocity[0, j] - velocity_kept[0, j]),
                fluid.gravity_y - per_dt * (velocity[1, j] - velocity_kept[1, j]),
                fluid.gravity_z - per_dt * (velocity[2, j] - velocity_kept[2, j]),
                p, poisson,
            )
            both = p + (solver_pressure[j] if poisson_diagonal[j] > real(0) else p + below) - twice
            x += both * pair_gradient[0, i, k]
            y += both * pair_gradient[1, i, k]
            z += both * pair_gradient[2, i, k]
    c = -mobility[i] * volume[i]
    pressure_acceleration[0, i] = c * x
    pressure_acceleration[1, i] = c * y
    pressure_acceleration[2, i] = c * z


def poisson_acceleration(
    position, velocity, velocity_kept, volume, mobility, poisson_diagonal, solver_pressure, surface_pressure, neighbour_count,
    neighbour_index, pair_gradient, poisson, fluid, period, dt, pressure_acceleration,
):
    """See `melt.reference.poisson.poisson_acceleration`."""
    _poisson_acceleration.launch(
        volume.shape[0], position, velocity, velocity_kept, volume, mobility, poisson_diagonal, solver_pressure, surface_pressure,
        neighbour_count, neighbour_index, pair_gradient, poisson, fluid, period, dt, pressure_acceleration,
    )


@cuda_kernel
def _poisson_finish(density_ratio, completed_ratio, poisson_diagonal, poisson, poisson_pressure, solver_pressure):
    i = cuda.grid(1)
    if i >= poisson_diagonal.shape[0]:
        return
    real = type(poisson.pull)
    wet = poisson_diagonal[i] > real(0)
    p = poisson_pressure[i] if wet else real(0)
    if poisson.clamp == 1 or density_ratio[i] < poisson.full_share:
        p = max(p, real(0))
    s = max(completed_ratio[i], real(0.5)) if wet else real(1)
    poisson_pressure[i] = p
    solver_pressure[i] = p / (s * s)


def poisson_finish(density_ratio, completed_ratio, poisson_diagonal, poisson, poisson_pressure, solver_pressure):
    """See `melt.reference.poisson.poisson_finish`."""
    _poisson_finish.launch(
        poisson_diagonal.shape[0], density_ratio, completed_ratio, poisson_diagonal, poisson, poisson_pressure,
        solver_pressure,
    )
