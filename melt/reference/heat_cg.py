r"""Backward Euler of all pairs at once, by conjugate gradients. Melting spec 2.5, 3.5.

    E_i(T_i') - E_i^n = dt \sum_j G_ij (T_j' - T_i'),   E = C T without latent heat.

With latent heat the states (below, on, above the plateau) are held while the linear system
is solved and renewed from the enthalpies that the solution implies (Voller's source
iteration; a semi-smooth Newton method). The step ends in flux form, antisymmetric in every
pair, so that the sum of E is kept to round-off however far the iteration went.
"""

import numpy as np

from melt.reference._enthalpy import Enthalpy
from melt.reference._shares import rows, shares


def cg_guess(temperature, temperature_next, heat_flux):
    """Write the first guess T' = T^n [degC] and no heat flux [J]."""
    temperature_next[:] = temperature
    heat_flux[:] = 0


def cg_state(
    heat_capacity, heat_capacity_molten, latent_point, latent_capacity, temperature, latent_energy,
    heat_flux, heat, temperature_next, heat_linear, heat_excess,
):
    """Write the linear system of the present states.

    The state of a particle is that of the enthalpy E^n + heat_flux. Below or above the
    plateau T' is moved to that side of the melting point; on it T' is held there.

    Reads: the enthalpy fields, temperature, latent_energy at t^n, heat_flux (n,) [J].
    Writes: temperature_next (n,) [degC], heat_linear (n,) [J/K] (inf: held),
        heat_excess (n,) [J] = E^n - E(T') on the branch of the state.
    """
    curve = Enthalpy(heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity)
    for i in range(len(temperature)):
        T, guess = float(temperature[i]), float(temperature_next[i])
        e = float(latent_energy[i]) if heat.latent else 0.0
        if np.isinf(curve.C[i]):
            temperature_next[i], heat_linear[i], heat_excess[i] = T, np.inf, 0.0
            continue
        if not curve.changes[i]:
            heat_linear[i], heat_excess[i] = curve.C[i], curve.C[i] * (T - guess)
            continue
        m, E = curve.m[i], curve.of(i, T, e)
        now = curve.temperature(i, E + float(heat_flux[i]))
        C = curve.C[i] if now < m else curve.C_molten[i]
        if now == m:
            temperature_next[i], heat_linear[i], heat_excess[i] = m, np.inf, 0.0
            continue
        guess = min(guess, m) if now < m else max(guess, m)
        base = 0.0 if now < m else curve.L[i]
        temperature_next[i], heat_linear[i], heat_excess[i] = guess, C, E - base - C * (guess - m)


def cg_start(
    temperature_next, heat_linear, heat_excess, heat_conductance, neighbour_count, neighbour_index, dt,
    cg_residual, cg_direction, cg_diagonal, cg_sums,
):
    """Write residual r, diagonal D, p = r/D and the partial sums of r.r/D (row 0)."""
    T, C = temperature_next.astype(float), heat_linear.astype(float)
    for i, near in rows(neighbour_count, neighbour_index):
        G = heat_conductance[i, : len(near)].astype(float)
        held = np.isinf(C[i])
        cg_residual[i] = 0.0 if held else heat_excess[i] + float(dt) * (G * (T[near] - T[i])).sum()
        cg_diagonal[i] = C[i] + float(dt) * G.sum()
        cg_direction[i] = cg_residual[i] / cg_diagonal[i] if cg_diagonal[i] > 0 else 0.0
    cg_sums[0] = [s.sum() for s in shares(cg_residual.astype(float) * cg_direction)]


def cg_apply(
    cg_direction, heat_linear, heat_conductance, neighbour_count, neighbour_index, dt, cg_product, cg_sums,
):
    """Write A p = C p + dt sum_j G_ij (p_i - p_j) and the partial sums of p.Ap (row 1)."""
    p, C = cg_direction.astype(float), heat_linear.astype(float)
    for i, near in rows(neighbour_count, neighbour_index):
        G = heat_conductance[i, : len(near)].astype(float)
        cg_product[i] = 0.0 if np.isinf(C[i]) else C[i] * p[i] + float(dt) * (G * (p[i] - p[near])).sum()
    cg_sums[1] = [s.sum() for s in shares(p * cg_product)]


def cg_step(cg_direction, cg_product, cg_diagonal, temperature_next, cg_residual, cg_sums):
    """Write T' += a p, r -= a A p, a = r.z / p.Ap, and the partial sums of the new r.r/D (row 2)."""
    curvature = cg_sums[1].sum()
    a = cg_sums[0].sum() / curvature if curvature > 0 else 0.0
    temperature_next[:] = temperature_next + a * cg_direction
    cg_residual[:] = cg_residual - a * cg_product
    z = cg_residual / np.where(cg_diagonal > 0, cg_diagonal, np.inf)
    cg_sums[2] = [s.sum() for s in shares(cg_residual * z)]


def cg_turn(cg_residual, cg_diagonal, cg_direction, cg_sums):
    """Write p = z + b p, b = new r.z / old r.z, and move the new sums into row 0."""
    old = cg_sums[0].sum()
    b = cg_sums[2].sum() / old if old > 0 else 0.0
    cg_direction[:] = cg_residual / np.where(cg_diagonal > 0, cg_diagonal, np.inf) + b * cg_direction
    cg_sums[0] = cg_sums[2]
