r"""Depth and support of each column, solved together. Flood spec 2, E3, E4, E8, E9, E14.

.. math:: R(d) = d - \sum_j V_j W(r_{ij}, h) - s \sum_b \max(0, b_i + d - z_b)\, V_b W(r_{ib}, h), \quad
          h = \mathrm{clamp}(\kappa \sqrt{V_i/d})

Newton: :math:`d \leftarrow d - R / [(2R + \alpha)/(2d) - \gamma]` with :math:`\alpha = -\sum V_j r W'` (walls, with
the depth that they carry, included) and :math:`\gamma = s \sum V_b W` over the walls that are wet; where h is
clamped, :math:`d \leftarrow d - R/(1 - \gamma)`. The walls' share s <= 1 keeps :math:`1 - \gamma` at
``shortest_wall`` at least (a column between walls on all sides is a cup that they would fill by themselves).
"""

import numpy as np

from melt.reference._flood import W2, apart, dW2

LEAST_SLOPE = 0.05  # of R; a column with hardly any neighbour has none


class _Column:
    """What one column needs of its neighbours: distances, volumes; of walls: distances, areas, bed above theirs."""

    def __init__(self, i, r, r_b, others, volume, bed, boundary_position, boundary_area, flood):
        self.V, self.flood = float(volume[i]), flood
        self.r = np.append(r[others], 0.0)
        self.volumes = np.append(volume[others].astype(np.float64), self.V)
        self.r_b, self.areas = r_b, boundary_area.astype(np.float64)
        self.above = float(bed[i]) - boundary_position[2].astype(np.float64)

    def sums(self, h, d):
        """Return S, alpha, gamma, and S without walls at support h and depth d. E3, E9, E14."""
        f = self.flood
        S_f = (self.volumes * W2(self.r, h, f)).sum()
        alpha = -(self.volumes * self.r * dW2(self.r, h, f)).sum()
        W, rdW = self.areas * W2(self.r_b, h, f), self.areas * self.r_b * dW2(self.r_b, h, f)
        if f.wall_mirror != 1:  # the paper's psi_b: a constant depth
            carried = float(f.reference_depth)
            return S_f + carried * W.sum(), alpha - carried * rdW.sum(), 0.0, S_f
        carried = np.maximum(self.above + d, 0.0)
        gamma = W[carried > 0].sum()
        most = 1 - float(f.shortest_wall)
        s = most / gamma if gamma > most else 1.0
        return S_f + s * (carried * W).sum(), alpha - s * (carried * rdW).sum(), s * gamma, S_f

    def support(self, d, least, most):
        with np.errstate(divide="ignore", invalid="ignore"):
            h = float(self.flood.ratio) * np.sqrt(self.V / d)
        return max(h, least) if h < most else most  # E8

    def solve(self, h_old):
        """Return h, d, Omega, whether h is clamped, and whether the iterations were enough. E9."""
        f = self.flood
        least, reach = float(f.smallest), float(f.growth) * h_old
        most = max(least, reach) if reach < float(f.largest) else float(f.largest)
        h = max(h_old, least) if h_old < most else most
        d = self.V * (float(f.ratio) / h) ** 2
        for _ in range(max(int(f.iterations), 1)):
            S, alpha, gamma, S_f = self.sums(h, d)
            R = d - S
            solved = bool(abs(R) <= float(f.tolerance) * d) or f.iterations == 0
            before = h
            if least < h < most and d > 0 and f.iterations > 0:
                slope = max((2 * R + alpha) / (2 * d) - gamma, LEAST_SLOPE)
                d = min(max(d - R / slope, 0.5 * d), 2 * d) if R == R else R
                h = self.support(d, least, most)
            else:  # linear in d but for walls that get wet or dry
                d = d - R / (1 - gamma)
                d = S_f if d < S_f else d
                h = self.support(d, least, most)
                solved = solved or (h == before and gamma == 0)
            if solved:
                break
        clamped = not (least < h < most)
        with np.errstate(divide="ignore", invalid="ignore"):
            omega = alpha / (2 * S)
        return h, d, 1.0 if clamped or omega < 0.2 else omega, clamped, solved


def flood_depth(
    position, phase, rest_volume, bed, neighbour_count, neighbour_index, wall_count, wall_index, boundary_position,
    boundary_area, flood, support_radius, depth, support_factor, depth_state,
):
    """Solve for depth and support of columns of water; falling ones get the depth of the water under them.

    The support grows by ``growth`` at most and is clamped to [``smallest``, ``largest``]; Omega = alpha/(2 d) is
    that of the last evaluation, 1 where any of these binds or where it is below 0.2. ``iterations`` = 0 (the
    paper): d is the sum at the old h, which follows afterwards. With ``wall_mirror`` = 0 walls carry the
    reference depth. A falling column (airborne) sums over water with its own support, which it keeps.

    Reads: position (3, n) [m], phase (n,), rest_volume (n,) [m^3], bed (n,) [m], neighbour_count (n,) (only
        whether it is below 3: pairs are tried), wall_count (its length is 0 without walls), boundary_position
        (3, b) [m], boundary_area (b,) [m^2].
    Writes: support_radius (n,) [m], read as that of before; depth (n,) [m]; support_factor (n,); depth_state (n,):
        1 h is the largest, 2 the smallest, 4 not solved within ``iterations``, 8 fewer than 3 neighbours.
    """
    none = wall_count.shape[0] == 0
    places, areas = (boundary_position[:, :0], boundary_area[:0]) if none else (boundary_position, boundary_area)
    r, r_b, water = apart(position, position), apart(position, places), phase == 0
    reach = float(flood.growth) * np.nan_to_num(support_radius.astype(np.float64), nan=0.0)
    for i in range(phase.shape[0]):
        depth[i], support_factor[i], depth_state[i] = 0, 1, 0
        h_old = float(support_radius[i])
        if phase[i] == 6:
            V = np.where(water, rest_volume, 0.0).astype(np.float64)
            depth[i] = (V * W2(r[i], h_old, flood)).sum()
        if phase[i] != 0:
            continue
        others = np.flatnonzero(water & (r[i] < np.maximum(reach[i], reach)) & (np.arange(len(phase)) != i))
        column = _Column(i, r[i], r_b[i], others, rest_volume, bed, places, areas, flood)
        h, d, omega, clamped, solved = column.solve(h_old)
        support_radius[i], depth[i], support_factor[i] = h, d, omega
        bits = (h >= float(flood.largest)) + 2 * (h <= float(flood.smallest)) + 4 * (not solved)
        depth_state[i] = bits + 8 * (neighbour_count[i] < 3)


def flood_surface(phase, bed, depth, position):
    """Write the height of the water surface, z = b + d, of columns of water. E4.

    Reads: phase (n,), bed (n,) [m], depth (n,) [m].
    Writes: position (3, n) [m], only its third row.
    """
    liquid = phase == 0
    position[2, liquid] = bed[liquid].astype(np.float64) + depth[liquid].astype(np.float64)
