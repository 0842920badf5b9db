"""Registry entries of the screen-space renderer, in the order in which a frame is drawn (see `melt.stages`)."""

from melt.registry import FEW, Tolerance, stage

_CAST = Tolerance(1e-5, 1e-11, "where a ray meets a sphere near its rim, half of the digits are lost")
_FIXED = Tolerance(2e-5, 1e-5, "sums in fixed point, so that they do not depend on the order; chords near a rim")
_BLEND = Tolerance(1e-5, 1e-9, "weighted mean; the weight is a series")
_SMEAR = Tolerance(4e-6, 1e-7, "mean of up to 60 values; the weight is a series")
_TURN = Tolerance(5e-5, 1e-11, "a normal from differences of nearly equal depths")
_LIGHT = Tolerance(1e-4, 2e-8, "power of a cosine, an exponential as a series; the spec allows 1/255")
_RAY = Tolerance(2e-5, 1e-10, "root of a quadratic in the cell that the ray meets")

LIST = [
    stage("relief_depth", "screen_relief", "flood 5 R0", "relief_height", "relief view", "behind_depth", _RAY),
    stage("screen_project", "screen_splat", "flood 5 R1", "position screen_radius", "view", "screen_sphere screen_box screen_skipped", FEW),
    stage("screen_depth", "screen_splat", "flood 5 R2", "screen_sphere screen_box behind_depth", "view", "screen_depth", _CAST),
    stage("screen_length", "screen_splat", "flood 5 R5", "screen_sphere screen_box behind_depth", "view splat",
           "screen_length screen_length_sum", _FIXED, scratch="screen_length_sum"),
    stage("screen_column", "screen_splat", "flood 5 R5", "screen_depth behind_depth", "view longest", "screen_length", FEW),
    stage("screen_value", "screen_splat", "flood 5 R6", "screen_sphere screen_box particle_value screen_depth", "view splat",
           "screen_value screen_value_sum", _FIXED, scratch="screen_value_sum"),
    stage("screen_blur", "screen_smooth", "flood 5 R5", "screen_length", "deviation along", "screen_length_next", _SMEAR),
    stage("bilateral", "screen_smooth", "flood 5 R3", "screen_depth", "filter view", "screen_depth_next", _BLEND),
    stage("bilateral_pass", "screen_smooth", "flood 5 R3", "screen_depth", "filter view along", "screen_depth_next", _BLEND),
    stage("narrow_pass", "screen_smooth", "flood 5 R3", "screen_depth", "filter view along", "screen_depth_next", _BLEND),
    stage("screen_normal", "screen_shade", "flood 5 R4", "screen_depth", "view", "screen_normal", _TURN),
    stage("screen_shade", "screen_shade", "flood 5 R6",
           "screen_depth screen_normal screen_length screen_value screen_map behind_depth behind_colour", "view optics", "picture", _LIGHT),
]
