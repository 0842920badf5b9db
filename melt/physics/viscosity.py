"""Laminar exchange of one pair with a liquid partner. Melting spec 2.3, (3')."""

from melt._compile import scalar
from melt.physics.phases import LIQUID
from melt.physics.smoothing import laplacian_weight


@scalar
def laminar_factor(
    r, phase_j, volume_i, mass_i, density_i, volume_j, mass_j, density_j, smoothing, fluid,
):
    r"""Return g [N s/m] of the force F = g (v_j - v_i) on the *liquid* i from j.

    .. math:: g = \mu \frac{m_i}{\rho_i} U L(r)

    U = m_j/rho_j for liquid j, rho0_i V_j/rho_i for a solid or wall; rho0 = m/V. Symmetric in
    a liquid pair, so the exchange conserves momentum.
    """
    own = mass_i / density_i
    liquid = phase_j == LIQUID
    other = mass_j / density_j if liquid else own / volume_i * volume_j
    return fluid.mu * own * other * laplacian_weight(r, smoothing)
