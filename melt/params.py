"""Constants handed to stages, as NamedTuples cast to the run's precision.

Build them only with `make`: an int in a float slot would silently compile a second copy
of every stage that takes it.
"""

from typing import NamedTuple

import numpy as np

from melt.params_boiling import Boiling, Bubbles, Condensate, Sph, Tank, Vapour  # noqa: F401
from melt.params_flood import (  # noqa: F401
    CONTROL_BEAD,
    CONTROL_DESCENT,
    CONTROL_PAPER,
    FORM_LINEAR,
    FORM_SYMMETRIC,
    FORM_VARIATIONAL,
    FORM_WELL_BALANCED,
    FRICTION_CHEZY,
    FRICTION_DARCY,
    FRICTION_MANNING,
    SAMPLER_BICUBIC,
    SAMPLER_BILINEAR,
    SAMPLER_BSPLINE,
    SIDE_OPEN,
    SIDE_WALL,
    Basin,
    Control,
    Flood,
    Friction,
    Sampling,
    Terrain,
)
from melt.params_screen import Filter, Optics, Relief, Splat, View  # noqa: F401
from melt.params_slime import (  # noqa: F401
    MASSLESS,
    ORPHAN,
    VISCOSITY_ARRHENIUS,
    VISCOSITY_CONSTANT,
    VISCOSITY_EXPONENTIAL,
    Apic,
    Dfsph,
    Elastic,
    Ghosts,
    Period,
    Poisson,
    Viscous,
)

CUBIC, WENDLAND2, MUELLER = range(3)
L_VISC, L_BROOK, L_BROOK_REGULAR = range(3)
ARTIFICIAL, LAMINAR = range(2)
VOLUME_REST, VOLUME_AKINCI, VOLUME_SHELL = range(3)
ROTATION_SVD, ROTATION_HORN, ROTATION_ITERATIVE = range(3)
HEAT_PAPER, HEAT_PHYSICAL = range(2)
REFILL_ALL, REFILL_CHANGED, REFILL_AFFECTED = range(3)
BOOST_OFF, BOOST_RATE, BOOST_LITERAL, BOOST_BOUSSINESQ, BOOST_VISCOSITY = range(5)
MASS_CARGO, MASS_NUCLEATE, MASS_RECYCLE = range(3)


class Smoothing(NamedTuple):
    """Smoothing function W, its gradient and the Laplacian weight L. Melting spec 2.1."""

    support: float  # support radius h [m]
    kernel: int  # CUBIC, WENDLAND2, MUELLER (poly6 for W, spiky for the gradient)
    laplacian: int  # L_VISC, L_BROOK, L_BROOK_REGULAR
    dimension: int = 3  # 2: normalised in the plane, per metre of depth


class Grid(NamedTuple):
    """Neighbour grid: cell edge >= support; cells (nx, ny, nz), x fastest."""

    origin_x: float  # [m]
    origin_y: float
    origin_z: float
    inverse_cell: float  # [1/m]
    nx: int
    ny: int
    nz: int


class Fluid(NamedTuple):
    """Weakly compressible liquid and its exchange with solids and walls. Spec 2.2-2.4."""

    sound_speed: float  # [m/s]
    viscosity: int  # ARTIFICIAL, or LAMINAR: the stage laminar_force with mu beside alpha
    alpha: float  # artificial viscosity [1]
    mu: float  # dynamic viscosity [Pa s]
    solid_friction: float  # sigma of liquid-solid pairs [1]
    wall_friction: float  # sigma of liquid-wall pairs [1]
    mirror: float  # beta of (2'): 1 solids carry the liquid's pressure, 0 literal
    clamp: int  # 1: pressure >= 0
    density_factor: float  # calibration of lattice density (1 unless calibrate_mass)
    minimum_volume: float  # V_min^0 [m^3]
    number_density: int  # 1: liquid enters sums by V_min (paper), 0: by its own V0
    gravity_x: float  # [m/s^2]
    gravity_y: float
    gravity_z: float
    expansion: float  # Boussinesq beta_T [1/K]
    reference_temperature: float  # [degC]
    drag: float  # ambient drag rate of liquids [1/s]
    xsph: float  # XSPH blend [1]
    surface_tension: float  # cohesion kappa [m^3/(kg s^2)], F = -kappa m_i sum m_j W x_ij
    central: float = 0.0  # pull towards the origin per distance [1/s^2]


class Lattice(NamedTuple):
    """Lattice shape matching. Spec 2.7, 3.2."""

    width: int  # w, hops of a region
    spacing: float  # dx [m]
    solid_volume: int  # VOLUME_REST, VOLUME_AKINCI, VOLUME_SHELL
    solid_scale: float  # phi_scale of solids
    rotation: int  # ROTATION_SVD, ROTATION_HORN, ROTATION_ITERATIVE
    iterations: int  # cap of ROTATION_ITERATIVE
    tolerance: float  # of ROTATION_ITERATIVE: stops at a turn whose square [rad^2] is below
    stiffness: float  # alpha_lsm
    damping: float  # k_damp per outer step
    refill: int  # REFILL_ALL, REFILL_CHANGED, REFILL_AFFECTED
    connect: int  # 6, 18 or 26 voxel neighbours bond


class Contact(NamedTuple):
    """Contact of solids with other solids and walls. Spec 3.3."""

    distance: float  # contact below this distance [m]
    stiffness: float  # k_c = stiffness * reduced mass / dt^2 (0.25)
    damping: float  # share of the normal approach speed that one pair removes per sub-step
    friction: float  # Coulomb coefficient
    connect: int  # 6, 18 or 26 voxel neighbours bond (of Lattice)


class Guard(NamedTuple):
    """Non-penetration guard of liquid against solids and walls. Spec 2.4."""

    distance: float  # d_min [m]


class Heat(NamedTuple):
    """Heat exchange. Spec 2.5, 3.5."""

    law: int  # HEAT_PAPER: kappa = K_i + K_j, C = V; HEAT_PHYSICAL: harmonic mean, C = m c
    current_volume: int  # 1: V = m/rho as the paper, 0: V0 (conserves energy)
    full_sweep: int  # 1: both sweeps with dt (literal), 0: dt/2 each (Strang)
    latent: int  # 1: latent heat is on
    ambient_temperature: float  # [degC]
    ambient_transfer: float  # h_c of free surfaces [W/(m^2 K)], (m/s in paper mode)
    ambient_area: float  # k_A of A = k_A dx^2 (1 - N/N_full); 8/3 makes a flat face dx^2 at h/dx 2.5
    full_neighbours: float  # N_full of a particle inside
    spacing: float  # dx [m]
    wall_fixed: int  # 1: walls keep their temperature and conduct, 0: insulated


class Change(NamedTuple):
    """Phase change. Spec 3.1, 3.4."""

    own_liquid: int  # 1: mass kept, V0 = m/rho_liquid; 0: becomes the ambient liquid, V0 kept
    latent: int  # 1: melts when latent_energy reaches latent_capacity
    hysteresis: float  # freezing starts this far below the melting point [K]
    reach: float  # freezing particle must be this close to the vacant site [m]


class Reconstruction(NamedTuple):
    """Surface of a set of particles. Spec 2.8."""

    reach: float  # R [m]; not larger than a cell of the grid
    radius: float  # r [m]
    correct: int  # 1: eigenvalue correction against sheets between approaching parts
    temperature: int  # 1: particles have a temperature


class Domain(NamedTuple):
    """Box outside of which particles count as lost. Spec 6."""

    lower_x: float
    lower_y: float
    lower_z: float
    upper_x: float
    upper_y: float
    upper_z: float
    delete: int  # 1: lost particles become inactive, 0: they fly on


class Pbf(NamedTuple):
    """Position based fluid: kernels with lattice normalisation, solve, velocity filters. Boiling spec 2.0-2.2, 2.6."""

    spacing: float  # d [m]
    support: float  # R, the largest support radius [m]
    uniform: int  # 1: every particle has the support R (no effect precision, or not of the support)
    same_iterations: int  # 1: every particle has all iterations
    value_scale: float  # of W1 at R: 315/(64 pi R^3 S) [1/m^3]
    gradient_scale: float  # of |grad W2| at R: 45/(pi R^4 G) [1/m^4]
    table_start: float  # R/d of the first point of `kernel_scale`
    table_step: float  # points per unit of R/d
    table_last: int  # index of the last point, which stands at R
    omega: float  # relaxation [1]
    softening: float  # eps = eps_rel D0 [1/(kg m^2)]
    minimum_error: float  # C_min: -1 two-sided, 0 only pushes apart
    push: float  # artificial pressure k_s/D0 [kg m^2]
    push_scale: float  # 1/(1 - (Dq/R)^2)
    blend: float  # gamma of XSPH [1/s]
    vorticity: float  # eps_v of vorticity confinement [m/s]
    iterations: int  # J
    minimum_iterations: int  # J_min
    minimum_support: float  # R_min [m]
    height_share: float  # a_F; b_F = 1 - a_F
    minimum_precision: float  # F_min
    precision_time: float  # time constant of F [s]
    floor: float  # height of the floor [m]
    inverse_bin: float  # 4/d, bins of the height histogram per metre


class Vessel(NamedTuple):
    """Box that liquid positions are clamped to: a quarter of a spacing inside the walls, open sides far away."""

    lower_x: float  # [m]
    lower_y: float
    lower_z: float
    upper_x: float
    upper_y: float
    upper_z: float


def make(kind, real, **values):
    """Return ``kind(**values)`` with every float cast to ``real`` and every int to int32.

    Raises:
        TypeError: a value is missing or unknown (from the NamedTuple itself).
    """
    cast = {
        name: (np.int32 if kind.__annotations__[name] is int else real)(value)
        for name, value in {**kind._field_defaults, **values}.items()
    }
    return kind(**cast)
