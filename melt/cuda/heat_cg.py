"""CUDA twin of `melt.reference.heat_cg`. Sums: one thread for each of 64 shares, added in order."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.heat import absorb


@cuda_kernel
def _cg_guess(temperature, temperature_next, heat_flux):
    i = cuda.grid(1)
    if i >= temperature.shape[0]:
        return
    temperature_next[i] = temperature[i]
    heat_flux[i] = temperature.dtype.type(0)


def cg_guess(temperature, temperature_next, heat_flux):
    """See `melt.reference.heat_cg.cg_guess`."""
    _cg_guess.launch(temperature.shape[0], temperature, temperature_next, heat_flux)


@cuda_kernel
def _cg_state(
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature, latent_energy,
    heat_flux, heat, temperature_next, heat_linear, heat_excess,
):
    i = cuda.grid(1)
    if i >= temperature.shape[0]:
        return
    real = type(heat.spacing)
    inf = real(math.inf)
    T, guess, C = temperature[i], temperature_next[i], heat_capacity[i]
    if C == inf:
        temperature_next[i] = T
        heat_linear[i] = inf
        heat_excess[i] = real(0)
        return
    if heat.latent == 0 or not latent_capacity[i] > real(0):
        heat_linear[i] = C
        heat_excess[i] = C * (T - guess)
        return
    e, m, molten, L = latent_energy[i], latent_point[i], heat_capacity_molten[i], latent_capacity[i]
    now, _ = absorb(heat_flux[i], T, e, m, C, molten, L)
    if now == m:
        temperature_next[i] = m
        heat_linear[i] = inf
        heat_excess[i] = real(0)
        return
    E = e + (T - m) * (C if T < m else molten)
    if now < m:
        guess = min(guess, m)
        heat_linear[i] = C
        heat_excess[i] = E - C * (guess - m)
    else:
        guess = max(guess, m)
        heat_linear[i] = molten
        heat_excess[i] = E - L - molten * (guess - m)
    temperature_next[i] = guess


def cg_state(
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature, latent_energy,
    heat_flux, heat, temperature_next, heat_linear, heat_excess,
):
    """See `melt.reference.heat_cg.cg_state`."""
    _cg_state.launch(
        temperature.shape[0], heat_capacity, heat_capacity_molten, latent_point, latent_capacity,
        temperature, latent_energy, heat_flux, heat, temperature_next, heat_linear, heat_excess,
    )


@cuda_kernel
def _cg_start(
    temperature_next, heat_linear, heat_excess, heat_conductance, neighbour_count, neighbour_index, dt,
    cg_residual, cg_direction, cg_diagonal,
):
    i = cuda.grid(1)
    if i >= heat_linear.shape[0]:
        return
    real = type(dt)
    T, flux, G = temperature_next[i], real(0), real(0)
    for entry in range(neighbour_count[i]):
        j = neighbour_index[i, entry]
        flux += heat_conductance[i, entry] * (temperature_next[j] - T)
        G += heat_conductance[i, entry]
    held = heat_linear[i] == real(math.inf)
    r = real(0) if held else heat_excess[i] + dt * flux
    diagonal = heat_linear[i] + dt * G
    cg_residual[i] = r
    cg_diagonal[i] = diagonal
    cg_direction[i] = r / diagonal if diagonal > real(0) else real(0)


@cuda_kernel
def _dot(a, b, row, cg_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    n = a.shape[0]
    total = a.dtype.type(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        total += a[i] * b[i]
    cg_sums[row, share] = total


def cg_start(
    temperature_next, heat_linear, heat_excess, heat_conductance, neighbour_count, neighbour_index, dt,
    cg_residual, cg_direction, cg_diagonal, cg_sums,
):
    """See `melt.reference.heat_cg.cg_start`."""
    _cg_start.launch(
        heat_linear.shape[0], temperature_next, heat_linear, heat_excess, heat_conductance, neighbour_count,
        neighbour_index, dt, cg_residual, cg_direction, cg_diagonal,
    )
    _dot.launch(64, cg_residual, cg_direction, 0, cg_sums)


@cuda_kernel
def _cg_apply(
    cg_direction, heat_linear, heat_conductance, neighbour_count, neighbour_index, dt, cg_product,
):
    i = cuda.grid(1)
    if i >= heat_linear.shape[0]:
        return
    real = type(dt)
    p, flux, C = cg_direction[i], real(0), heat_linear[i]
    for entry in range(neighbour_count[i]):
        j = neighbour_index[i, entry]
        flux += heat_conductance[i, entry] * (p - cg_direction[j])
    cg_product[i] = real(0) if C == real(math.inf) else C * p + dt * flux


def cg_apply(
    cg_direction, heat_linear, heat_conductance, neighbour_count, neighbour_index, dt, cg_product, cg_sums,
):
    """See `melt.reference.heat_cg.cg_apply`."""
    _cg_apply.launch(
        heat_linear.shape[0], cg_direction, heat_linear, heat_conductance, neighbour_count, neighbour_index,
        dt, cg_product,
    )
    _dot.launch(64, cg_direction, cg_product, 1, cg_sums)


@cuda_kernel
def _cg_step(cg_direction, cg_product, temperature_next, cg_residual, cg_sums):
    i = cuda.grid(1)
    if i >= cg_residual.shape[0]:
        return
    real = cg_residual.dtype.type
    old, curvature = real(0), real(0)
    for share in range(64):
        old += cg_sums[0, share]
        curvature += cg_sums[1, share]
    a = old / curvature if curvature > real(0) else real(0)
    temperature_next[i] += a * cg_direction[i]
    cg_residual[i] -= a * cg_product[i]


@cuda_kernel
def _preconditioned(cg_residual, cg_diagonal, cg_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    real = cg_residual.dtype.type
    n = cg_residual.shape[0]
    total = real(0)
    for i in range(share * n // 64, (share + 1) * n // 64):
        if cg_diagonal[i] > real(0):
            total += cg_residual[i] * (cg_residual[i] / cg_diagonal[i])
    cg_sums[2, share] = total


def cg_step(cg_direction, cg_product, cg_diagonal, temperature_next, cg_residual, cg_sums):
    """See `melt.reference.heat_cg.cg_step`."""
    _cg_step.launch(cg_residual.shape[0], cg_direction, cg_product, temperature_next, cg_residual, cg_sums)
    _preconditioned.launch(64, cg_residual, cg_diagonal, cg_sums)


@cuda_kernel
def _cg_turn(cg_residual, cg_diagonal, cg_direction, cg_sums):
    i = cuda.grid(1)
    if i >= cg_residual.shape[0]:
        return
    real = cg_residual.dtype.type
    old, new = real(0), real(0)
    for share in range(64):
        old += cg_sums[0, share]
        new += cg_sums[2, share]
    b = new / old if old > real(0) else real(0)
    z = cg_residual[i] / cg_diagonal[i] if cg_diagonal[i] > real(0) else real(0)
    cg_direction[i] = z + b * cg_direction[i]


@cuda_kernel
def _keep_sums(cg_sums):
    share = cuda.grid(1)
    if share >= 64:
        return
    cg_sums[0, share] = cg_sums[2, share]


def cg_turn(cg_residual, cg_diagonal, cg_direction, cg_sums):
    """See `melt.reference.heat_cg.cg_turn`."""
    _cg_turn.launch(cg_residual.shape[0], cg_residual, cg_diagonal, cg_direction, cg_sums)
    _keep_sums.launch(64, cg_sums)
