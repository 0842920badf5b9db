"""CPU twin of `melt.reference.screen_shade`."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.screen_light import behind, body, doubled, lit, mixed, slope

CHUNKS, SPREAD = 64, 37  # odd: every chunk comes once, and neighbours go to different threads


@cpu_stage
def screen_normal(screen_depth, view, screen_normal):
    """See `melt.reference.screen_shade.screen_normal`."""
    real = screen_depth.dtype.type
    height, width = screen_depth.shape
    none, per, half = real(np.inf), real(1) / view.focal, real(0.5)
    for piece in prange(CHUNKS):
        chunk = piece * SPREAD % CHUNKS
        for row in range(chunk * height // CHUNKS, (chunk + 1) * height // CHUNKS):
            v = (real(row) + half - view.centre_y) * per
            for column in range(width):
                depth = screen_depth[row, column]
                if not depth < none:
                    screen_normal[0, row, column] = screen_normal[1, row, column] = real(0)
                    screen_normal[2, row, column] = real(-1)
                    continue
                u = (real(column) + half - view.centre_x) * per
                right = screen_depth[row, column + 1] if column + 1 < width else none
                left = screen_depth[row, column - 1] if column > 0 else none
                below = screen_depth[row + 1, column] if row + 1 < height else none
                above = screen_depth[row - 1, column] if row > 0 else none
                a, s = slope(depth, right, left, none)
                b, t = slope(depth, below, above, none)
                s, t = (s if s != 0 else real(1)), (t if t != 0 else real(1))
                # tangents s (u a + s (D + a)/f, v a, a) and t (u b, v b + t (D + b)/f, b); their product is written out
                e, g = (depth + a) * per, (depth + b) * per
                x, y = s * a * g, t * b * e
                z = -(e * g + s * u * a * g + t * v * b * e)
                size = real(1) / math.sqrt(x * x + y * y + z * z)
                screen_normal[0, row, column], screen_normal[1, row, column] = x * size, y * size
                screen_normal[2, row, column] = z * size


@cpu_stage
def screen_shade(
    screen_depth, screen_normal, screen_length, screen_value, screen_map, behind_depth, behind_colour,
    view, optics, picture,
):
    """See `melt.reference.screen_shade.screen_shade`."""
    real = screen_depth.dtype.type
    height, width = screen_depth.shape
    none, per, half = real(np.inf), real(1) / view.focal, real(0.5)
    for piece in prange(CHUNKS):
        chunk = piece * SPREAD % CHUNKS
        for row in range(chunk * height // CHUNKS, (chunk + 1) * height // CHUNKS):
            v = (real(row) + half - view.centre_y) * per
            for column in range(width):
                depth = screen_depth[row, column]
                own = behind_colour[0, row, column], behind_colour[1, row, column], behind_colour[2, row, column]
                if not depth < none:
                    picture[0, row, column], picture[1, row, column], picture[2, row, column] = own
                    continue
                u = (real(column) + half - view.centre_x) * per
                nx, ny, nz = screen_normal[0, row, column], screen_normal[1, row, column], screen_normal[2, row, column]
                F, mirrored, shine, light = lit(u, v, nx, ny, nz, optics)
                length = doubled(screen_length, row, column)
                shift = optics.refraction * length * view.focal / depth
                back = behind(real(column) - shift * nx, real(row) - shift * ny, depth, own, behind_depth, behind_colour)
                liquid = body(row, column, screen_value, screen_map, optics)
                picture[0, row, column] = mixed(liquid[0], back[0], mirrored[0], optics.absorb_red, length, light, F, shine)
                picture[1, row, column] = mixed(liquid[1], back[1], mirrored[1], optics.absorb_green, length, light, F, shine)
                picture[2, row, column] = mixed(liquid[2], back[2], mirrored[2], optics.absorb_blue, length, light, F, shine)
