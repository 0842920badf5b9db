r"""Surface field of Zhu and Bridson (2005). Melting spec 2.8.

.. math::
    \phi(x) = |x - \bar x| - f r, \quad \bar x = \frac{\sum_j w_j x_j}{\sum_j w_j}, \quad
    w_j = \max(0, (1 - |x - x_j|^2 / R^2)^3)

f = 1, or with ``correct`` the correction by the largest eigenvalue EV of the gradient of
:math:`\bar x` (Solenthaler et al. 2007), which removes sheets between parts that approach:
f = 1 for EV < 0.4, else g^3 - 3 g^2 + 3 g with g = (3.5 - EV)/3.1, at least 0. The gradient is
not symmetric; EV is that of its symmetric part, an upper bound of the real parts.
"""

import numpy as np

CHUNK = 2048  # nodes at a time: the tables are dense


def surface_field(
    position, temperature, cell_start, surface_node, grid, reconstruction,
    surface_distance, surface_temperature,
):
    """Write the surface field and the temperature, both weighted alike, at nodes.

    Reads: position (3, n) [m] of the particles that make up the surface, sorted by cell;
        temperature (n,) [degC] (length 0 if reconstruction.temperature is 0); cell_start
        (cells + 2,), whose last range is left out; surface_node (3, m) [m].
    Writes: surface_distance (m,) [m], negative inside, cut off at +r; surface_temperature (m,)
        [degC], 0 where no particle is within the reach (and W < 1e-12, a hundred-thousandth of R
        inside it, fades to 0, so that rounding at the reach makes no jump).
    """
    active = int(cell_start[-2])
    x_j = np.asarray(position, np.float64)[:, :active]
    T_j = np.asarray(temperature, np.float64)[:active]
    R, r = float(reconstruction.reach), float(reconstruction.radius)
    for start in range(0, surface_node.shape[1], CHUNK):
        part = slice(start, start + CHUNK)
        x = np.asarray(surface_node, np.float64)[:, part]
        d = x_j[:, None, :] - x[:, :, None]  # (3, nodes, particles)
        s = (d**2).sum(axis=0) / R**2
        w = np.where(s < 1, (1 - np.minimum(s, 1)) ** 3, 0.0)  # w_j
        W = w.sum(axis=1)
        some = W > 0
        W1 = np.where(some, W, 1.0)
        mean = (w * d).sum(axis=2) / W1  # xbar - x
        f = _correction(d, s, W1, mean, R) if reconstruction.correct else 1.0
        phi = np.sqrt((mean**2).sum(axis=0)) - f * r
        surface_distance[part] = np.where(some, np.minimum(phi, r), r)
        surface_temperature[part] = w @ T_j / np.maximum(W, 1e-12) if reconstruction.temperature else 0.0


def _correction(d, s, W, mean, R):
    """Return f of every node from the gradient of xbar, dxbar_b/dx_a."""
    g = np.where(s < 1, 6 / R**2 * (1 - np.minimum(s, 1)) ** 2, 0.0)  # grad w_j = g (x_j - x)
    J = np.einsum("nj,anj,bnj->nab", g, d, d) / W[:, None, None]
    J -= np.einsum("nj,anj,bn->nab", g, d, mean) / W[:, None, None]
    EV = np.linalg.eigvalsh(0.5 * (J + J.swapaxes(1, 2)))[:, -1]
    g = np.clip((3.5 - EV) / 3.1, 0, 1)
    return np.where(EV < 0.4, 1.0, g**3 - 3 * g**2 + 3 * g)
