"""Constants of boiling: a part of `melt.params`, from where they are imported."""

from typing import NamedTuple


class Boiling(NamedTuple):
    """Heat of the liquid, vaporisation, velocity boost. Boiling spec 2.3, 2.4, 3."""

    diffusivity: float  # alpha [m^2/s]
    corrected: int  # 1: eq (11), 0: eq (10)
    specific_heat: float  # c_p [J/(kg K)]
    boiling_point: float  # T_b [degC]
    latent_heat: float  # L_eff [J/kg]: a particle vaporises when its store holds it
    start_temperature: float  # T_0 [degC]
    threshold: int  # of the nucleation draw, of 2^30
    seed_low: int  # words of the seed, as int32 bit patterns
    seed_high: int
    mass_model: int  # MASS_CARGO, MASS_NUCLEATE, MASS_RECYCLE
    subcooling: float  # MASS_NUCLEATE: a particle cools by this when it sends out bubbles [K]
    heater_lower_x: float  # heated part of the floor [m]
    heater_upper_x: float
    heater_lower_y: float
    heater_upper_y: float
    contact: float  # liquid below this height touches the heater [m]
    boost: int  # BOOST_OFF, BOOST_RATE, BOOST_LITERAL, BOOST_BOUSSINESQ, BOOST_VISCOSITY
    boost_rate: float  # k_T [1/s] (1 for BOOST_LITERAL)
    boost_speed: float  # v_b [m/s]
    expansion: float  # beta_T of BOOST_BOUSSINESQ [1/K]


class Bubbles(NamedTuple):
    """Radius, rise, merging and bursting of bubbles. Boiling spec 2.5."""

    spacing: float  # d [m]
    birth_radius: float  # r_b0 [m]
    birth_reach: float  # R_s: bubbles are born within this distance [m]
    inertia: float  # rho_g + C_A rho_0 [kg/m^3], I_b = inertia V
    rise_x: float  # a_B = -g (rho_0 - rho_g)/inertia [m/s^2]
    rise_y: float
    rise_z: float
    drag: float  # (3/8) C_D rho_0/inertia [1]: k = drag/r
    literal_radius: int  # 1: the paper's radius law
    growth: float  # beta/alpha
    radius_height: float  # alpha of the paper's law [1]
    radius_rate: float  # beta of the paper's law [1/s]
    depth: float  # H_w, depth of the liquid at the start [m]
    growth_time: float  # t_ref [s]
    largest: float  # r_max: growth stops [m]
    most_volume: float  # volume by which a bubble displaces at most [m^3]
    merge_age: float  # t_imm: younger bubbles do not merge [s]
    plain_mean: int  # 1: merged bubbles stand at the plain mean of the places
    upward: int  # 1: merged velocity keeps its vertical part only
    drift: float  # kappa R/dt_ref [m/s] (normalised) or kappa d/dt_ref per count
    normalised: int  # 1: (X+ - X-)/(X+ + X-)
    burst_radius: float  # r_s: smaller bubbles vanish without a push [m]
    push_reach: float  # k_b R [m]
    push_side: float  # l_1/t_p [1/s]
    push_up: float  # l_2/t_p [1/s]
    push_even: int  # 1: w = 1 within reach, 0: w = 1 - q
    floor: float  # [m]
    lower_x: float  # box of the walls; 1e30 away where there is none [m]
    lower_y: float
    lower_z: float
    upper_x: float
    upper_y: float
    upper_z: float


class Vapour(NamedTuple):
    """Vapour above the surface. Boiling spec 2.6, eq (16)."""

    support: float  # R' [m]
    minimum_support: float  # R'_min [m]
    mass: float  # of a particle [kg]
    rest_density: float  # [kg/m^3]
    stiffness: float  # k_v: p = k_v max(rho - rest_density, 0) [J/kg]
    buoyancy_x: float  # -g beta_v [m/(s^2 K)]
    buoyancy_y: float
    buoyancy_z: float
    air_temperature: float  # [degC]
    drag: float  # rate of slowing down in still air [1/s]
    life: float  # [s]
    density_share: float  # a_S; b_S = 1 - a_S
    adapt: int  # 1: eq (16), 0: R' for all
    per_burst: int  # particles that a burst sets free
    spread: float  # new particles start within this distance of the burst [m]


class Tank(NamedTuple):
    """Grid of eq (9) over the liquid as it stands at the start: cells a spacing wide, insulated. Boiling spec 2.3."""

    origin_x: float  # lower corner [m]
    origin_y: float
    origin_z: float
    inverse_cell: float  # 1/d [1/m]
    nx: int
    ny: int
    nz: int
    number: float  # alpha/d^2 [1/s]
    capacity: float  # rho_0 c_p d^3 [J/K]


class Sph(NamedTuple):
    """Mueller 2003's weakly compressible SPH, the baseline of the paper's Table 1. Boiling spec 1."""

    support: float  # R [m]
    rest_density: float  # rho_0 [kg/m^3]
    stiffness: float  # k: P = k max(rho/rho_0 - 1, 0), rho_0 c_s^2 [Pa]
    viscosity: float  # mu [Pa s]


class Condensate(NamedTuple):
    """Liquid that returns as condensate: a whole particle on the surface (MASS_RECYCLE). Boiling spec 3."""

    lower_x: float  # box of the places where it enters, half a spacing inside the domain [m]
    lower_y: float
    width_x: float  # [m]
    width_y: float
    mass: float  # of a particle [kg]
    volume: float  # [m^3]
    temperature: float  # [degC]
