r"""What the solvers need of every pair, once per sub-step. Slime spec 2.7, S5b, in the volume form.

With V the rest volume of a particle (m/rho0 of liquid, psi/rho0 of a boundary) and g_ij = V_j grad_i W_ij

.. math:: s_i = \frac{\rho_i}{\rho_0} = V_i W_0 + \sum_j V_j W_{ij}, \qquad
          \frac{D s_i}{D t} = \sum_j \vec g_{ij} \cdot (\vec v_i - \vec v_j)

A pressure p_i alone accelerates i by -(V_i/m_i) p_i sum_j g_ij and each j, by reaction, by
(V_j/m_j) p_i V_i grad_i W_ij = (V_i/m_j) p_i g_ij. Inserted into D s/D t the rate of change is -p_i D_i,

.. math:: D_i = \frac{V_i}{m_i} \Big| \sum_j \vec g_{ij} \Big|^2 + V_i \sum_j \frac{|\vec g_{ij}|^2}{m_j}

which is the denominator of alpha with the m_i m_j of unequal masses (the papers print m_j^2), and
without the reaction of those that cannot be accelerated (walls, driven bodies, held liquid).
"""

import numpy as np

from melt.reference._pairs import W, gradW
from melt.reference._period import nearest


def mobility(phase, mass, held, mobility):
    """Write 1/m of free liquid and of solids, 0 of all others and of what has no mass.

    Reads: phase (n,), mass (n,) [kg], held (n,): 1 for liquid whose velocity is given.
    Writes: mobility (n,) [1/kg].
    """
    m = mass.astype(np.float64)
    free = (((phase == 0) & (held == 0)) | (phase == 1)) & (m > 0)
    mobility[:] = np.where(free, 1 / np.where(free, m, 1), 0.0)


def pair_gradient(
    position, phase, volume, mobility, neighbour_count, neighbour_index, smoothing, period, dfsph,
    pair_gradient, density_ratio, dfsph_factor,
):
    """Write g_ij = V_j grad_i W_ij of the list of each particle, the density ratio, and 1/D_i.

    The factor is 0 for all but free liquid with mass, and where D_i m_i / V_i = |sum g|^2 + m_i sum |g|^2/m_j
    is below ``least``. Distances are those to the nearest image; the gradient of a coincident pair is 0.
    Reads: position (3, n) [m], phase (n,), volume (n,) [m^3], mobility (n,) [1/kg], the lists.
    Writes: pair_gradient (3, n, capacity) [1/m], up to the count; density_ratio (n,), 1 for all but liquid, 0 for
        inactive slots; dfsph_factor (n,) = 1/D_i [kg/m].
    """
    x, V, w = position.astype(np.float64), volume.astype(np.float64), mobility.astype(np.float64)
    capacity = neighbour_index.shape[1]
    for i in range(len(phase)):
        near = neighbour_index[i, : min(neighbour_count[i], capacity)]
        x_ij = nearest(x[:, i : i + 1] - x[:, near], period)
        r = np.sqrt((x_ij**2).sum(axis=0))
        g = V[near] * gradW(x_ij, r, smoothing)
        pair_gradient[:, i, : len(near)] = g
        density_ratio[i] = 0.0 if phase[i] == 5 else 1.0
        dfsph_factor[i] = 0.0
        if phase[i] != 0:
            continue
        density_ratio[i] = V[i] * W(0.0, smoothing) + (V[near] * W(r, smoothing)).sum()
        if w[i] > 0:
            squares = (g.sum(axis=1) ** 2).sum() + (w[near] * (g**2).sum(axis=0)).sum() / w[i]
            if squares >= float(dfsph.least):
                dfsph_factor[i] = 1 / (w[i] * V[i] * squares)
