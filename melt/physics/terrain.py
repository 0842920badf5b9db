"""Values of the terrain grid between its nodes. Flood spec 2, E5.

Of the bed, value and slope are those of one function: the quadratic B-spline (C1, never beyond its nodes),
bilinear patches (slope jumps at node lines), or Catmull-Rom's bicubic (C1, through its nodes, overshoots at
cliffs). Numbers of nodes are clamped at the edges, which continues the bed by a constant; a NaN position
reads node 0. Sums are taken from differences of elevations: 1e3 m of height would cost float32 its slopes.
"""

import numpy as np

from melt._compile import scalar, scalar_lookup
from melt.params import SAMPLER_BICUBIC, SAMPLER_BSPLINE


@scalar
def node_coordinate(x, origin, inverse, count):
    """Return x in node distances from node 0, in the precision of x, cut where the bed is constant anyway."""
    wide = type(x)
    t = (x - wide(origin)) * wide(inverse)
    if t >= wide(count + 1):
        return wide(count + 1)
    return t if t > wide(-2) else wide(-2)  # NaN, too


@scalar
def whole(t):
    """Return floor(t) of a coordinate of `node_coordinate`."""
    k = np.int32(t)
    return k - np.int32(1) if type(t)(k) > t else k


@scalar
def inside(k, count):
    """Return the node k of 0 .. count - 1 along an axis; those outside count as the nearest of the edge."""
    return min(max(k, np.int32(0)), np.int32(count - 1))


@scalar
def node_number(i, j, terrain_grid):
    """Return the number of node (i, j)."""
    return np.uint64(inside(j, terrain_grid.ny) * np.int32(terrain_grid.nx) + inside(i, terrain_grid.nx))


@scalar
def place_of(x, y, terrain_grid):
    """Return (t_x, t_y) of `node_coordinate`."""
    t_x = node_coordinate(x, terrain_grid.origin_x, terrain_grid.inverse_dx, terrain_grid.nx)
    return t_x, node_coordinate(y, terrain_grid.origin_y, terrain_grid.inverse_dy, terrain_grid.ny)


@scalar
def spline(z0, z1, z2, u):
    """Return value, slope, curvature per node distance of the quadratic B-spline at u in [-1/2, 1/2] from z1. E5."""
    real = type(u)
    a, b = real(0.5) - u, real(0.5) + u
    low, high = z0 - z1, z2 - z1
    return z1 + real(0.5) * (a * a * low + b * b * high), b * high - a * low, low + high


@scalar
def cubic(z0, z1, z2, z3, u):
    """Return value, slope, curvature per node distance of Catmull-Rom's spline at u in [0, 1] from z1."""
    real = type(u)
    e, f, g = z0 - z1, z2 - z1, z3 - z1
    c1 = real(0.5) * (f - e)
    c2 = e + real(2) * f - real(0.5) * g
    c3 = real(0.5) * (g - e) - real(1.5) * f
    slope = c1 + u * (real(2) * c2 + real(3) * u * c3)
    return z1 + u * (c1 + u * (c2 + u * c3)), slope, real(2) * c2 + real(6) * u * c3


@scalar
def nearest_node(t_x, t_y, real):
    """Return the node (i, j) nearest to a place and (u, v) from it, in the type of ``real``."""
    i, j = whole(t_x + type(t_x)(0.5)), whole(t_y + type(t_y)(0.5))
    return i, j, type(real)(t_x - type(t_x)(i)), type(real)(t_y - type(t_y)(j))


@scalar_lookup
def spline_row(row, i, j, k, u, terrain):
    """Return `spline` along x of nodes i, j, k of the row that starts at node ``row``."""
    return spline(terrain[np.uint64(row + i)], terrain[np.uint64(row + j)], terrain[np.uint64(row + k)], u)


@scalar_lookup
def spline_patch(t_x, t_y, terrain, terrain_grid):
    """Return (b, x, y, xx, yy, xy) per node distance."""
    one, nx, ny = np.int32(1), np.int32(terrain_grid.nx), np.int32(terrain_grid.ny)
    i, j, u, v = nearest_node(t_x, t_y, terrain_grid.inverse_dx)
    west, here, east = inside(i - one, nx), inside(i, nx), inside(i + one, nx)
    b0, s0, c0 = spline_row(inside(j - one, ny) * nx, west, here, east, u, terrain)
    b1, s1, c1 = spline_row(inside(j, ny) * nx, west, here, east, u, terrain)
    b2, s2, c2 = spline_row(inside(j + one, ny) * nx, west, here, east, u, terrain)
    b, y, yy = spline(b0, b1, b2, v)
    x, xy, _ = spline(s0, s1, s2, v)
    xx, _, _ = spline(c0, c1, c2, v)
    return b, x, y, xx, yy, xy


@scalar_lookup
def cubic_row(row, i, j, k, n, u, terrain):
    """Return `cubic` along x of nodes i, j, k, n of the row that starts at node ``row``."""
    return cubic(terrain[np.uint64(row + i)], terrain[np.uint64(row + j)], terrain[np.uint64(row + k)], terrain[np.uint64(row + n)], u)


@scalar_lookup
def cubic_patch(t_x, t_y, terrain, terrain_grid):
    """Return (b, x, y, xx, yy, xy) per node distance."""
    real, one, two = terrain.dtype.type, np.int32(1), np.int32(2)
    nx, ny = np.int32(terrain_grid.nx), np.int32(terrain_grid.ny)
    i, j = whole(t_x), whole(t_y)
    u, v = real(t_x - type(t_x)(i)), real(t_y - type(t_y)(j))
    w, m, e, f = inside(i - one, nx), inside(i, nx), inside(i + one, nx), inside(i + two, nx)
    b0, s0, c0 = cubic_row(inside(j - one, ny) * nx, w, m, e, f, u, terrain)
    b1, s1, c1 = cubic_row(inside(j, ny) * nx, w, m, e, f, u, terrain)
    b2, s2, c2 = cubic_row(inside(j + one, ny) * nx, w, m, e, f, u, terrain)
    b3, s3, c3 = cubic_row(inside(j + two, ny) * nx, w, m, e, f, u, terrain)
    b, y, yy = cubic(b0, b1, b2, b3, v)
    x, xy, _ = cubic(s0, s1, s2, s3, v)
    xx, _, _ = cubic(c0, c1, c2, c3, v)
    return b, x, y, xx, yy, xy


@scalar_lookup
def linear_patch(t_x, t_y, terrain, terrain_grid):
    """Return (b, x, y, xx, yy, xy) per node distance."""
    real, one = terrain.dtype.type, np.int32(1)
    i, j = whole(t_x), whole(t_y)
    u, v = real(t_x - type(t_x)(i)), real(t_y - type(t_y)(j))
    b = terrain[node_number(i, j, terrain_grid)]
    low = terrain[node_number(i + one, j, terrain_grid)] - b
    left = terrain[node_number(i, j + one, terrain_grid)] - b
    twist = (terrain[node_number(i + one, j + one, terrain_grid)] - b) - low - left
    return b + u * low + v * (left + u * twist), low + v * twist, left + u * twist, real(0), real(0), twist


# Each of the following picks its patch by itself and returns at one place: a shared function that picks costs
# half as much again (numba counts references to the array across it; 40 instead of 24 ns a place, measured).


@scalar_lookup
def bed_value(x, y, terrain, terrain_grid):
    """Return b(x, y) [m], by the sampler of the grid."""
    t_x, t_y = place_of(x, y, terrain_grid)
    if terrain_grid.sampler == SAMPLER_BSPLINE:
        b, _, _, _, _, _ = spline_patch(t_x, t_y, terrain, terrain_grid)
    elif terrain_grid.sampler == SAMPLER_BICUBIC:
        b, _, _, _, _, _ = cubic_patch(t_x, t_y, terrain, terrain_grid)
    else:
        b, _, _, _, _, _ = linear_patch(t_x, t_y, terrain, terrain_grid)
    return b


@scalar_lookup
def bed_sample(x, y, terrain, terrain_grid):
    """Return (b, db/dx, db/dy), the exact derivatives of `bed_value`."""
    t_x, t_y = place_of(x, y, terrain_grid)
    if terrain_grid.sampler == SAMPLER_BSPLINE:
        b, s_x, s_y, _, _, _ = spline_patch(t_x, t_y, terrain, terrain_grid)
    elif terrain_grid.sampler == SAMPLER_BICUBIC:
        b, s_x, s_y, _, _, _ = cubic_patch(t_x, t_y, terrain, terrain_grid)
    else:
        b, s_x, s_y, _, _, _ = linear_patch(t_x, t_y, terrain, terrain_grid)
    return b, s_x * terrain_grid.inverse_dx, s_y * terrain_grid.inverse_dy


@scalar_lookup
def bed_second(x, y, terrain, terrain_grid):
    """Return the second derivatives (xx, yy, xy) of b [1/m]."""
    t_x, t_y = place_of(x, y, terrain_grid)
    if terrain_grid.sampler == SAMPLER_BSPLINE:
        _, _, _, xx, yy, xy = spline_patch(t_x, t_y, terrain, terrain_grid)
    elif terrain_grid.sampler == SAMPLER_BICUBIC:
        _, _, _, xx, yy, xy = cubic_patch(t_x, t_y, terrain, terrain_grid)
    else:
        _, _, _, xx, yy, xy = linear_patch(t_x, t_y, terrain, terrain_grid)
    p, q = terrain_grid.inverse_dx, terrain_grid.inverse_dy
    return xx * (p * p), yy * (q * q), xy * (p * q)


@scalar_lookup
def bilinear_value(field, terrain_grid, x, y):
    """Return a field of the nodes at (x, y), bilinear whatever the sampler of the bed."""
    t_x, t_y = place_of(x, y, terrain_grid)
    return linear_patch(t_x, t_y, field, terrain_grid)[0]


@scalar_lookup
def bilinear_gradient(field, terrain_grid, x, y):
    """Return the gradient of `bilinear_value` [per m]."""
    t_x, t_y = place_of(x, y, terrain_grid)
    _, s_x, s_y, _, _, _ = linear_patch(t_x, t_y, field, terrain_grid)
    return s_x * terrain_grid.inverse_dx, s_y * terrain_grid.inverse_dy


@scalar_lookup
def nearest_value(field, terrain_grid, x, y):
    """Return a field of the nodes at the node nearest to (x, y)."""
    t_x, t_y = place_of(x, y, terrain_grid)
    half = type(t_x)(0.5)
    return field[node_number(whole(t_x + half), whole(t_y + half), terrain_grid)]
