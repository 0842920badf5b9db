"""Equation of state of the weakly compressible liquid. Melting spec 2.3."""

from melt._compile import scalar


@scalar
def tait(density, rest_density, fluid):
    r"""Return the Tait pressure [Pa].

    .. math:: p = B ((\rho/\rho_0)^7 - 1), \quad B = \rho_0 c_s^2 / 7

    With ``fluid.clamp`` it is never negative. The seventh power is spelled out once, here, so
    that all backends round it alike (a library `pow` differs between host and device).
    """
    real = type(density)
    ratio = density / rest_density
    ratio3 = ratio * ratio * ratio
    stiffness = rest_density * fluid.sound_speed * fluid.sound_speed * real(1 / 7)
    pressure = stiffness * (ratio3 * ratio3 * ratio - real(1))
    if fluid.clamp == 1 and pressure < real(0):  # a NaN passes on to where it is noticed
        return real(0)
    return pressure
