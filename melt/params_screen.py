"""Constants of the screen-space renderer: a part of `melt.params`, from where they are imported."""

from typing import NamedTuple


class View(NamedTuple):
    """Camera: eye, rows right, down, forward of its frame, pinhole in pixels. Flood spec 5."""

    eye_x: float  # [m]
    eye_y: float
    eye_z: float
    right_x: float
    right_y: float
    right_z: float
    down_x: float
    down_y: float
    down_z: float
    forward_x: float
    forward_y: float
    forward_z: float
    focal: float  # [px]
    centre_x: float  # [px]
    centre_y: float
    far: float  # what is farther away is not drawn; a power of two [m]
    smallest: float  # radius of the smallest disc drawn [px]
    below: int  # 1: a sphere hangs below its particle's position, which is on the surface (shallow water)


class Splat(NamedTuple):
    """Sums over the spheres of a pixel. Fixed point: quantum x largest term x particles < 2^31."""

    length_steps: float  # steps of thickness [1/m]
    value_steps: float  # steps of a weight, which is at most 1
    reach: float  # spheres this far behind the surface have no part in its value [m]


class Filter(NamedTuple):
    """Smoothing of the depth. Flood spec 5, R3."""

    size: float  # sigma_w: standard deviation of the window [m]
    smallest: float  # of the window's standard deviation [px]
    largest: float  # [px]
    range: float  # sigma_r of the bilateral filter [m]
    narrow: float  # delta of the narrow-range filter [m]
    clamp: float  # mu of the narrow-range filter [m]


class Optics(NamedTuple):
    """Shading of liquid. Flood spec 5, R6."""

    fresnel: float  # F0, reflected head-on
    refraction: float  # beta_r: shift of what lies behind per thickness and sine of the tilt
    absorb_red: float  # kappa [1/m]
    absorb_green: float
    absorb_blue: float
    body_red: float  # C_fluid
    body_green: float
    body_blue: float
    mapped: int  # 1: C_fluid is the colour of the value on the map
    ambient: float  # share of C_fluid that needs no light from the sun
    shine: float  # k_s
    doublings: int  # alpha = 2^doublings
    sun_x: float  # towards the sun, in the camera frame
    sun_y: float
    sun_z: float
    up_x: float  # up, in the camera frame
    up_y: float
    up_z: float
    zenith_red: float  # sky overhead, at the horizon, and what is seen below it
    zenith_green: float
    zenith_blue: float
    horizon_red: float
    horizon_green: float
    horizon_blue: float
    nadir_red: float
    nadir_green: float
    nadir_blue: float


class Relief(NamedTuple):
    """Grid of a height field: node [0, 0] and the distance of nodes. Flood spec 5, R0."""

    lower_x: float  # [m]
    lower_y: float
    cell_x: float  # [m]
    cell_y: float
    base: float  # the ground is a block down to this height, whose cut faces are seen [m]
