"""Weight of a pair in XSPH, compiled with the flags of the loops that call it.

The formula of `melt.physics.pbf.xsph_weight`: a scalar is compiled without fastmath, and the compiler could no
longer put the products in an order that suits the whole loop (nor give the bits that it gave in one).
"""

import math

from melt._compile import cpu_helper
from melt.physics.pbf import poly6


@cpu_helper
def xsph_weight(r2, inverse, m_i, m_j, V_i, V_j):
    """See `melt.physics.pbf.xsph_weight`."""
    real = type(r2)
    W1 = poly6(r2, inverse, real(315 / (64 * math.pi)) * inverse * inverse * inverse)
    return m_j / (m_i + m_j) * (V_i + V_j) * W1
