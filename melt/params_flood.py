"""Constants of the shallow water flood: a part of `melt.params`, from where they are imported."""

from typing import NamedTuple

FORM_VARIATIONAL, FORM_SYMMETRIC, FORM_WELL_BALANCED, FORM_LINEAR = range(4)
SAMPLER_BSPLINE, SAMPLER_BILINEAR, SAMPLER_BICUBIC = range(3)
CONTROL_PAPER, CONTROL_DESCENT, CONTROL_BEAD = range(3)
FRICTION_MANNING, FRICTION_CHEZY, FRICTION_DARCY = range(3)
SIDE_WALL, SIDE_OPEN = range(2)


class Flood(NamedTuple):
    """Columns of water: support, depth, forces. Flood spec 2, E3-E10, E14-E16."""

    gravity: float  # g [m/s^2]
    kernel: int  # CUBIC or WENDLAND2 (of `melt.params`), in two dimensions, support radius h = 2 l
    sigma: float  # discrete normalisation 1/(1 + beta_lat) [1]
    ratio: float  # h = ratio sqrt(V/d), 2 x 1.33
    smallest: float  # h is clamped to [smallest, largest] [m]
    largest: float
    growth: float  # neighbour lists reach growth * max(h_i, h_j): h grows by at most this factor in a sub-step
    iterations: int  # Newton steps for the depth (0: depth at the h of the last sub-step, the paper)
    tolerance: float  # |R|/d below which the depth counts as solved [1]
    form: int  # FORM_VARIATIONAL, FORM_SYMMETRIC, FORM_WELL_BALANCED, FORM_LINEAR
    stiffness: float  # k of FORM_LINEAR, p/rho_0 = k (d/d_ref - 1) [m^2/s^2]
    reference_depth: float  # d_ref: of FORM_LINEAR, and of walls with mirror = 0 [m]
    clamp: int  # FORM_LINEAR: pressure >= 0
    lax_friedrichs: float  # alpha_LF of E10 [1]
    viscosity: float  # nu of E7 [m^2/s]
    wall_mirror: int  # 1: walls carry the stage of the water beside them, 0: the reference depth (paper)
    shortest_wall: float  # least denominator of the depth beside walls [1] (0.3)
    front: float  # FORM_WELL_BALANCED: |eta_j - eta_i| above front * d_i turns on the whole pressure (0.02)


class Terrain(NamedTuple):
    """Grid of bed elevations: node (0, 0) is the south-west one, x fastest. Flood spec 2, E5."""

    origin_x: float  # of node (0, 0) [m]
    origin_y: float
    inverse_dx: float  # [1/m]
    inverse_dy: float
    nx: int
    ny: int
    sampler: int  # SAMPLER_BSPLINE, SAMPLER_BILINEAR, SAMPLER_BICUBIC


class Control(NamedTuple):
    """Terrain velocity control force. Flood spec 3, E11-E13."""

    mode: int  # CONTROL_PAPER, CONTROL_DESCENT, CONTROL_BEAD
    slope_on: float  # s_on: weight 0 up to this drop per metre [1]
    slope_full: float  # s_full: weight 1 from here; <= s_on: 1 everywhere (paper)
    spread: float  # c_s: corners at +-c_s h_i [1]
    shortest: float  # clamp of that length [m]
    longest: float
    probe: float  # least length of the probe, half a cell of the terrain [m]


class Basin(NamedTuple):
    """Edges of the flooded area, and how far a column may move in a sub-step. Flood spec stage 4."""

    lower_x: float  # [m]
    lower_y: float
    upper_x: float
    upper_y: float
    west: int  # SIDE_WALL, SIDE_OPEN
    east: int
    south: int
    north: int
    longest_move: float  # a longer move in a sub-step is cut [m]
    guard: int  # 1: the terrain has places that water may not enter (`terrain_wall`)
    skin: float  # columns stay this far from walls [m]


class Friction(NamedTuple):
    """Bed friction, point-implicit. Flood spec 2, E15."""

    law: int  # FRICTION_MANNING, FRICTION_CHEZY, FRICTION_DARCY
    value: float  # n [s m^-1/3], C [m^1/2/s] or f [1] where no map is given
    mapped: int  # 1: `terrain_friction` holds the value of each node
    thinnest: float  # d_f: depths below count as this [m]
    control: int  # 1: the control force brakes, too


class Sampling(NamedTuple):
    """Depth at points of a map and at gauges. Flood spec 9."""

    cover: float  # a point is wet where the sum of A_j W_j exceeds this [1] (0.5)
    wet: float  # depth from which a point counts as reached [m]
