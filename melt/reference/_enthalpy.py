"""Enthalpy of particles and the exchange of one pair, in float64. Melting spec 2.5, 3.5."""

import numpy as np

from melt.reference._pairs import L as laplacian_weight
from melt.reference._pairs import separations


def conductances(position, conductivity, heat_volume, smoothing, heat):
    """Return G_ij = kappa_ij V_i V_j L_ij [W/K], shape (n, n), 0 beyond the support and for i = j."""
    _, r = separations(position)
    k = np.asarray(conductivity, dtype=np.float64)
    V = np.asarray(heat_volume, dtype=np.float64)
    if heat.law == 0:
        kappa = k[:, None] + k[None, :]  # eq (4): K_i + K_j
    else:
        total = k[:, None] + k[None, :]
        kappa = 2 * k[:, None] * k[None, :] / np.where(total > 0, total, 1.0)
    L = np.where(r < float(smoothing.support), laplacian_weight(r, smoothing), 0.0)
    G = kappa * V[:, None] * V[None, :] * L
    np.fill_diagonal(G, 0.0)
    return G


class Enthalpy:
    """E(T, latent energy) of particles and its inverse; arrays of one entry per particle."""

    def __init__(self, heat, heat_capacity, heat_capacity_molten, latent_point, latent_capacity):
        n = len(heat_capacity)
        self.C = np.asarray(heat_capacity, dtype=np.float64)
        on = bool(heat.latent)
        self.L = np.asarray(latent_capacity, dtype=np.float64) if on else np.zeros(n)
        self.changes = (self.L > 0) & np.isfinite(self.C)
        self.m = np.where(self.changes, latent_point if on else 0.0, 0.0)
        self.C_molten = np.where(self.changes, heat_capacity_molten if on else self.C, self.C)

    def of(self, i, T, e):
        """Return E_i [J]."""
        if not self.changes[i]:
            return self.C[i] * T
        return e + (self.C[i] if T < self.m[i] else self.C_molten[i]) * (T - self.m[i])

    def temperature(self, i, E):
        """Return T [degC] of the enthalpy E."""
        if not self.changes[i]:
            return E / self.C[i]
        if E < 0:
            return self.m[i] + E / self.C[i]
        return self.m[i] + max(E - self.L[i], 0.0) / self.C_molten[i]

    def absorb(self, i, q, T, e):
        """Return (T, latent energy) after the heat q."""
        if np.isinf(self.C[i]) or q == 0:
            return T, e
        E = self.of(i, T, e) + q
        if not self.changes[i]:
            return E / self.C[i], e
        return self.temperature(i, E), min(max(E, 0.0), self.L[i])

    def kinks(self, i, T, e):
        """Return the heats q at which dT/dq of particle i changes."""
        if not self.changes[i]:
            return []
        E = self.of(i, T, e)
        return [-E, self.L[i] - E]

    def after(self, i, q, T, e):
        """Return T_i after the heat q, fixed temperatures included."""
        return self.absorb(i, q, T, e)[0]

    def exchange(self, g, i, j, T, e):
        """Step pair (i, j) alone by backward Euler: q = g (T_j' - T_i'), g = dt G_ij; in place.

        q - g (T_j' - T_i') is increasing and piecewise linear: the straight piece that holds
        its root lies between two neighbouring kinks, and there the root is a quotient.
        """
        D = T[j] - T[i]
        if g == 0 or D == 0:
            return

        def imbalance(q):
            return q - g * (self.after(j, -q, T[j], e[j]) - self.after(i, q, T[i], e[i]))

        far = g * D  # more than this never flows
        kinks = self.kinks(i, T[i], e[i]) + [-q for q in self.kinks(j, T[j], e[j])]
        ends = sorted([0.0, far] + [q for q in kinks if min(0.0, far) < q < max(0.0, far)])
        values = [imbalance(q) for q in ends]
        k = max([a for a in range(len(ends) - 1) if values[a] <= 0], default=0)
        run = values[k + 1] - values[k]
        q = ends[k] - values[k] * (ends[k + 1] - ends[k]) / run if run > 0 else ends[k]
        T[i], e[i] = self.absorb(i, q, T[i], e[i])
        T[j], e[j] = self.absorb(j, -q, T[j], e[j])


def latent_of(heat, latent_energy, n):
    """Return a float64 copy of the latent energies, zeros where the scene has none."""
    return np.array(latent_energy, dtype=np.float64) if heat.latent else np.zeros(n)
