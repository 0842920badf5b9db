r"""Volumes by which particles enter SPH sums. Melting spec 2.2.

Liquid: V_min^0 in the paper's number-density form, else its own V0. Walls: V0 (phi = 1).
Solids: phi_k V_min^0 by one of the stages below, phi_k = V_k^t / V_min^0.
"""

import numpy as np

from melt.reference._pairs import W, separations


def liquid_volume(phase, rest_volume, fluid, volume):
    """Write the volume of liquid and walls, a start value V0 for solids, 0 for all others.

    Reads: phase (n,), rest_volume (n,) [m^3]. Writes: volume (n,) [m^3].
    """
    V = np.where(fluid.number_density == 1, fluid.minimum_volume, rest_volume)
    volume[:] = np.where(phase == 0, V, np.where(np.isin(phase, (1, 2, 7)), rest_volume, 0.0))


def rest_sum(site_rest, site_region, site_region_count, smoothing, rest_sum):
    """Write S_k^0 = Sum_l W(X0_k - X0_l) over the region of each site, itself included.

    Reads: site_rest (3, s) [m], site_region (s, R), site_region_count (s,).
    Writes: rest_sum (s,) [1/m^3]; 0 for sites that are not live.
    """
    X = np.asarray(site_rest, dtype=np.float64)
    for s in range(X.shape[1]):
        members = site_region[s][site_region[s] >= 0]
        r = np.sqrt(((X[:, [s]] - X[:, members]) ** 2).sum(axis=0))
        rest_sum[s] = W(r, smoothing).sum() if site_region_count[s] > 0 else 0.0


def solid_volume_rest(
    position, rest_volume, site_particle, site_region, site_region_count, rest_sum,
    smoothing, lattice, volume,
):
    """Write phi_k V_min^0 = phi_scale V_k^0 S_k^0 / S_k^t of solid particles (variant ``rest``).

    Reads: position (3, n) [m], rest_volume (n,) [m^3], site_particle (s,), site_region (s, R),
        site_region_count (s,), rest_sum S^0 (s,) [1/m^3].
    Writes: volume (n,) [m^3] of the particles of live sites.
    """
    x = np.asarray(position, dtype=np.float64)
    for s, k in enumerate(site_particle):
        if k < 0 or site_region_count[s] == 0:
            continue
        members = site_particle[site_region[s][site_region[s] >= 0]]
        S = W(np.sqrt(((x[:, [k]] - x[:, members]) ** 2).sum(axis=0)), smoothing).sum()
        volume[k] = float(lattice.solid_scale) * float(rest_volume[k]) * float(rest_sum[s]) / S


def solid_volume_akinci(
    position, phase, site, site_component, site_link_count, neighbour_count, neighbour_index,
    smoothing, lattice, volume,
):
    """Write phi_k V_min^0 = phi_scale / Sum_l W(x_kl), l over solids of the same piece, k included.

    Variant ``shell`` (``lattice.solid_volume`` = 2): only surface particles (a bond is
    missing: at most ``lattice.connect`` live links, their own counted) exist for the liquid, also in
    the sum; the others get 0.
    Reads: position (3, n) [m], phase (n,), site (n,), site_component (s,), site_link_count (s,).
    Writes: volume (n,) [m^3] of solid particles.
    """
    _, r = separations(position)
    solid = np.flatnonzero(phase == 1)
    component = site_component[site[solid]]
    counts = np.ones(solid.size, bool)
    if lattice.solid_volume == 2:
        counts = site_link_count[site[solid]] < lattice.connect + 1
    w = W(r[np.ix_(solid, solid)], smoothing)
    w = np.where((component[:, None] == component[None, :]) & counts[None, :], w, 0.0)
    total = np.where(counts, w.sum(axis=1), 1.0)
    volume[solid] = np.where(counts, float(lattice.solid_scale) / total, 0.0)
