"""CPU twin of `melt.reference.screen_relief`: a walk from cell to cell along the ray."""

import math

import numpy as np

from melt._compile import cpu_stage, prange
from melt.physics.relief import enter, gap, meet, next_line


@cpu_stage
def relief_depth(relief_height, relief, view, behind_depth):
    """See `melt.reference.screen_relief.relief_depth`."""
    real = behind_depth.dtype.type
    height, width = behind_depth.shape
    ny, nx = relief_height.shape
    none, per, half = real(np.inf), real(1) / view.focal, real(0.5)
    x0, y0 = (view.eye_x - relief.lower_x) / relief.cell_x, (view.eye_y - relief.lower_y) / relief.cell_y
    for row in prange(height):
        v = (real(row) + half - view.centre_y) * per
        for column in range(width):
            u = (real(column) + half - view.centre_x) * per
            dx = (u * view.right_x + v * view.down_x + view.forward_x) / relief.cell_x
            dy = (u * view.right_y + v * view.down_y + view.forward_y) / relief.cell_y
            dz = u * view.right_z + v * view.down_z + view.forward_z
            t, leave = enter(x0, dx, y0, dy, real(nx - 1), real(ny - 1))
            found = none
            i = min(max(int(math.floor(x0 + dx * t)), 0), nx - 2) if t < leave else 0
            j = min(max(int(math.floor(y0 + dy * t)), 0), ny - 2) if t < leave else 0
            if 0 < t < leave:
                a, b, c, d = relief_height[j, i], relief_height[j, i + 1], relief_height[j + 1, i], relief_height[j + 1, i + 1]
                below = gap(x0 - real(i), dx, y0 - real(j), dy, view.eye_z, dz, t, a, b, c, d) <= real(0)
                found = t if below and view.eye_z + dz * t >= relief.base else none  # a cut face of the block
            while found == none and t < leave and 0 <= i < nx - 1 and 0 <= j < ny - 1:
                tx, ty = next_line(x0, dx, i), next_line(y0, dy, j)
                after = max(min(tx, ty, leave), t)
                a, b, c, d = relief_height[j, i], relief_height[j, i + 1], relief_height[j + 1, i], relief_height[j + 1, i + 1]
                first = gap(x0 - real(i), dx, y0 - real(j), dy, view.eye_z, dz, t, a, b, c, d)
                last = gap(x0 - real(i), dx, y0 - real(j), dy, view.eye_z, dz, after, a, b, c, d)
                if first > real(0) and last <= real(0):
                    middle = gap(x0 - real(i), dx, y0 - real(j), dy, view.eye_z, dz, half * (t + after), a, b, c, d)
                    found = t + (after - t) * meet(first, middle, last)
                i += (1 if dx > 0 else -1) if tx <= ty else 0
                j += (1 if dy > 0 else -1) if ty < tx else 0
                t = after
            behind_depth[row, column] = found
