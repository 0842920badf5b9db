"""Terrain velocity control force, bed friction, and what they leave of a speed. Flood spec 2 and 3, E11-E15."""

from melt._compile import scalar, scalar_lookup
from melt.params import CONTROL_DESCENT, CONTROL_PAPER, FRICTION_CHEZY, FRICTION_MANNING
from melt.physics.terrain import bed_value

STILL = 1e-6  # moves shorter than this part of the least probe have no direction


@scalar
def brake_of(s, control, flood):
    """Return f [m/s^2] where the bed falls by s per metre: exactly 0 on flat ground. E11."""
    real = type(s)
    steep, span = abs(s), control.slope_full - control.slope_on
    t = real(1)
    if span > real(0):
        t = (steep - control.slope_on) / span
        t = real(0) if t < real(0) else t  # NaN stays
        t = real(1) if t > real(1) else t
    f = flood.gravity * steep * (t * t * (real(3) - real(2) * t)) * (s * s) / (real(1) + s * s)
    if control.mode == CONTROL_PAPER:
        return f
    if control.mode == CONTROL_DESCENT:
        return real(0) if s < real(0) else f
    return -f if s < real(0) else f


@scalar_lookup
def brake_at(x, y, p_x, p_y, length, terrain, terrain_grid, control, flood):
    """Return f [m/s^2] at (x, y), for a probe (p_x, p_y) of that length."""
    ahead = bed_value(x + p_x, y + p_y, terrain, terrain_grid)
    return brake_of((bed_value(x, y, terrain, terrain_grid) - ahead) / length, control, flood)


@scalar
def probe_length(move, control):
    """Return |p| [m]: the move, or the least probe. E11."""
    return control.probe if move < control.probe else move  # NaN stays


@scalar
def half_side(h, control):
    """Return half the side of the square whose corners are probed [m]. E13."""
    return min(max(control.spread * h, control.shortest), control.longest)


@scalar_lookup
def mean_brake(x, y, dx, dy, move, h, terrain, terrain_grid, control, flood):
    """Return the mean brake [m/s^2] at the corners of the square around a column that moved by (dx, dy). E12."""
    wide = type(x)
    length, side = probe_length(move, control), wide(half_side(h, control))
    p_x, p_y = wide(dx * (length / move)), wide(dy * (length / move))
    total = brake_at(x - side, y - side, p_x, p_y, length, terrain, terrain_grid, control, flood)
    total += brake_at(x - side, y + side, p_x, p_y, length, terrain, terrain_grid, control, flood)
    total += brake_at(x + side, y - side, p_x, p_y, length, terrain, terrain_grid, control, flood)
    total += brake_at(x + side, y + side, p_x, p_y, length, terrain, terrain_grid, control, flood)
    return type(h)(0.25) * total


@scalar
def friction_rate(value, depth, friction, flood):
    """Return C [1/m] of the friction slope S_f = C |v| v. E15."""
    real = type(depth)
    d = friction.thinnest if depth < friction.thinnest else depth  # NaN stays
    if friction.law == FRICTION_MANNING:
        return flood.gravity * value * value / (d * d ** real(1 / 3))
    if friction.law == FRICTION_CHEZY:
        return flood.gravity / (value * value * d)
    return value / (real(8) * d)


@scalar
def brake_factor(brake, dt, speed):
    """Return what the control force leaves of a speed, at most 1.5 of it. E12b."""
    real = type(speed)
    if speed == real(0):
        return real(1)
    share = real(1) - brake * dt / speed
    share = real(0) if share < real(0) else share  # NaN stays
    return real(1.5) if share > real(1.5) else share
