"""Constants of incompressible and viscous liquids: a part of `melt.params`, from where they are imported."""

from typing import NamedTuple

VISCOSITY_CONSTANT, VISCOSITY_ARRHENIUS, VISCOSITY_EXPONENTIAL = range(3)
MASSLESS, ORPHAN = 1, 1  # values of node_state and apic_state


class Period(NamedTuple):
    """Periodic axes: a distance along one is taken to the nearest image, d - length round(d inverse). Slime spec 1."""

    length_x: float  # [m]; 0 for an axis that is not periodic
    length_y: float
    length_z: float
    inverse_x: float  # 1/length [1/m]; 0 for an axis that is not periodic
    inverse_y: float
    inverse_z: float
    lower_x: float  # where the periodic box begins [m]
    lower_y: float
    lower_z: float


class Dfsph(NamedTuple):
    """Divergence-free and constant-density solver. Slime spec 2.7."""

    omega: float  # relaxation of the Jacobi iteration
    warm: float  # share of the last impulse that a solve starts with
    warm_limit: float  # at most this many times the first iterate of a cold start
    fewest: int  # neighbours below which divergence is not corrected
    least: float  # dfsph_factor is 0 where |sum grad|^2 + sum |grad|^2 is below this [1/m^2]


class Poisson(NamedTuple):
    """ISPH pressure Poisson equation. Slime spec 2.9."""

    rest_density: float  # [kg/m^3]
    floor: float  # eps^2 = (0.01 h)^2 of the Laplacian [m^2]
    pull: float  # beta_rho: share of a density deficit that is asked back
    full_share: float  # below this density ratio negative pressure is cut to 0
    clamp: int  # 1: all negative pressure is cut
    full: float = 0.0  # without ghosts: least sum of V F over neighbours inside the liquid; what lacks is air [1/m^2]; 0: there is no air


class Ghosts(NamedTuple):
    """Air ghost particles. Slime spec 2.8. Candidates stand on a lattice of `across` points per edge of a grid cell."""

    across: int  # lattice points along a cell edge (1 along an axis without extent)
    flat: int  # 1: two dimensions, one layer of points in y
    pitch: float  # distance of lattice points, cell edge / across [m]
    distance: float  # r_pd: least distance from nodes, walls and each other [m]
    jitter: float  # largest shift of a candidate from its lattice point along each axis [m]
    fill: float  # largest liquid fill of a candidate
    volume: float  # d0^d: volume of a node at rest, for the fill [m^3]
    plane: float  # y of the plane in two dimensions [m]
    seed_low: int  # words of the seed, as int32 bit patterns
    seed_high: int


class Viscous(NamedTuple):
    """Implicit viscosity and its law. Slime spec 2.11."""

    law: int  # VISCOSITY_CONSTANT, VISCOSITY_ARRHENIUS, VISCOSITY_EXPONENTIAL
    mu: float  # viscosity at reference_temperature, at a shear rate of 1/s where power < 1 [Pa s]
    slope: float  # ARRHENIUS: activation temperature E/R [K]; EXPONENTIAL: rate [1/K]
    reference_temperature: float  # [degC]
    power: float  # n of the power law; 1: Newtonian (not `index`: CUDA finds the method of tuples)
    yield_stress: float  # tau_y [Pa]
    yield_rate: float  # m of the regularised yield stress [s]
    smallest: float  # caps of mu [Pa s]
    largest: float
    wall: float  # viscosity of the pair with a wall in units of the liquid's: 0 free slip, 2 no slip (mirrored), more: sticky
    strength: float  # 2 (d + 2), d the dimension
    floor: float  # eps_v h^2 [m^2]
    gamma: float  # augmented Lagrangian: gamma/mu; 0: viscosity alone


class Apic(NamedTuple):
    """Transfers between APIC particles and nodes. Slime spec 2.1-2.6."""

    support: float  # h_t, radius of the transfer weights [m]; not above the edge of a grid cell
    kernel: int  # as Smoothing
    dimension: int  # 2 or 3
    affine: int  # 0: PIC, the affine velocity is dropped (to show what it loses)
    literal: int  # 1: positions by the patent's (1.8) (to show that they collapse)
    flip: float  # share of FLIP
    rank: float  # eigenvalues of D below this are dropped [m^2]
    orphan: float  # S_p below this: no node near enough [1/m^3]
    massless: float  # node masses below this are none [kg]
    most: float  # no node has a larger volume [m^3]
    rest_density: float  # [kg/m^3]


class Elastic(NamedTuple):
    """Oldroyd-B stress on APIC particles. Slime spec 2.13."""

    modulus: float  # G [Pa]
    relaxation: float  # lambda_r [s]
    dimension: int  # 2 or 3
