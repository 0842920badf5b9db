"""Force of one pair with a liquid partner: liquid-liquid, liquid-solid, liquid-wall.

One formula serves the liquid (`fluid_force`) and the solid beside it (`reaction_force`): the
solid evaluates what its liquid neighbour receives, with the sign of x_ij turned, so that
momentum closes to round-off without a scatter. Melting spec 2.3, 2.4.
"""

from melt._compile import scalar
from melt.physics.phases import LIQUID, SOLID
from melt.physics.smoothing import dW_over_r


@scalar
def bounded(head, pressure):
    """Return the hydrostatic difference ``head`` [Pa] within -|pressure| and |pressure|."""
    limit = abs(pressure)
    return max(min(head, limit), -limit)


@scalar
def pair_factor(
    r2, v_x, g_x, phase_j, volume_i, mass_i, density_i, pressure_i, boundary_i,
    volume_j, mass_j, density_j, pressure_j, smoothing, fluid,
):
    r"""Return f [N/m] of the force F = f x_ij on the *liquid* i from j.

    .. math::
        f = \Big( -V_i V_j (s_i + t_j)
            + m_i M_j \nu_{ij} \frac{\min(v_{ij} \cdot x_{ij}, 0)}{r^2 + 0.01 (h/2)^2} \Big) \frac{W'}{r}

    with s = p (rho0/rho)^2, rho0 = m/V. Liquid j: t_j = s_j, M_j = m_j, nu = alpha h c_s /
    (rho_i + rho_j). Solid or wall j (2', 3'): t_j = mirror p_j, M_j = rho0_i V_j, nu = sigma h
    c_s / (4 rho_i). A boundary carries the pressure of the liquid around i, P_i (``boundary_i``, see
    `melt.reference.pressure.boundary_pressure`), as it would be at its place in a liquid at rest:
    p_j = P_i - rho_i g . x_ij within 0 and 2 P_i. With p_i alone (2') the liquid beside a vertical
    wall lacks that half of the pressure gradient and sinks, and since mirror p_i has no potential
    each particle draws energy from its own pressure: a tank 4 m deep never rests (0.35 m/s; 0.01 m/s
    with P_i), and bodies are lifted by 1.2 times the displaced weight (1.01 with P_i), all measured.
    Phases are told apart by selects: branches would stop vectorisation.

    Arguments: r2 [m^2], v_x = v_ij . x_ij [m^2/s], g_x = g . x_ij [m^2/s^2], phase of j,
    volumes [m^3], masses [kg], densities [kg/m^3], pressures [Pa].
    """
    real = type(r2)
    h = smoothing.support
    liquid = phase_j == LIQUID
    rest_i = mass_i / volume_i
    over_i = mass_i / (volume_i * density_i)  # rho0/rho; rounded as over_j, so liquid pairs close
    # of a boundary particle the density is i's own; volume_j may be 0 there (never divided by)
    other_density = density_j if liquid else density_i
    other_mass = mass_j if liquid else rest_i * volume_j
    over_j = mass_j / ((volume_j if liquid else real(1)) * other_density)
    # a drop that slides down a wall has no pressure and feels no buoyancy
    carried = boundary_i - bounded(density_i * g_x, boundary_i)
    other_term = pressure_j * over_j * over_j if liquid else fluid.mirror * carried
    boundary_friction = real(0.5) * (fluid.solid_friction if phase_j == SOLID else fluid.wall_friction)
    alpha = fluid.alpha if liquid else boundary_friction
    approach = min(v_x, real(0))
    push = -volume_i * volume_j * (pressure_i * over_i * over_i + other_term)
    damping = (
        mass_i * other_mass * alpha * h * fluid.sound_speed * approach
        / ((density_i + other_density) * (r2 + real(0.0025) * h * h))
    )
    return (push + damping) * dW_over_r(r2, smoothing)
