"""CUDA twin of `melt.reference.screen_relief`: a walk from cell to cell along the ray."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.relief import enter, gap, meet, next_line


@cuda_kernel
def _relief_depth(relief_height, relief, view, behind_depth):
    k = cuda.grid(1)
    height, width = behind_depth.shape
    if k >= height * width:
        return
    real = behind_depth.dtype.type
    ny, nx = relief_height.shape
    per, half = real(1) / view.focal, real(0.5)
    row, column = k // width, k % width
    u, v = (real(column) + half - view.centre_x) * per, (real(row) + half - view.centre_y) * per
    x0, y0 = (view.eye_x - relief.lower_x) / relief.cell_x, (view.eye_y - relief.lower_y) / relief.cell_y
    dx = (u * view.right_x + v * view.down_x + view.forward_x) / relief.cell_x
    dy = (u * view.right_y + v * view.down_y + view.forward_y) / relief.cell_y
    dz = u * view.right_z + v * view.down_z + view.forward_z
    t, leave = enter(x0, dx, y0, dy, real(nx - 1), real(ny - 1))
    behind_depth[row, column] = real(math.inf)
    if not t < leave:
        return
    i = min(max(int(math.floor(x0 + dx * t)), 0), nx - 2)
    j = min(max(int(math.floor(y0 + dy * t)), 0), ny - 2)
    if t > real(0):
        a, b, c, d = relief_height[j, i], relief_height[j, i + 1], relief_height[j + 1, i], relief_height[j + 1, i + 1]
        below = gap(x0 - real(i), dx, y0 - real(j), dy, view.eye_z, dz, t, a, b, c, d) <= real(0)
        if below and view.eye_z + dz * t >= relief.base:  # a cut face of the block
            behind_depth[row, column] = t
            return
    while t < leave and 0 <= i < nx - 1 and 0 <= j < ny - 1:
        tx, ty = next_line(x0, dx, i), next_line(y0, dy, j)
        after = max(min(tx, ty, leave), t)
        a, b, c, d = relief_height[j, i], relief_height[j, i + 1], relief_height[j + 1, i], relief_height[j + 1, i + 1]
        first = gap(x0 - real(i), dx, y0 - real(j), dy, view.eye_z, dz, t, a, b, c, d)
        last = gap(x0 - real(i), dx, y0 - real(j), dy, view.eye_z, dz, after, a, b, c, d)
        if first > real(0) and last <= real(0):
            middle = gap(x0 - real(i), dx, y0 - real(j), dy, view.eye_z, dz, half * (t + after), a, b, c, d)
            behind_depth[row, column] = t + (after - t) * meet(first, middle, last)
            return
        if tx <= ty:
            i += 1 if dx > real(0) else -1
        else:
            j += 1 if dy > real(0) else -1
        t = after


def relief_depth(relief_height, relief, view, behind_depth):
    """See `melt.reference.screen_relief.relief_depth`."""
    _relief_depth.launch(behind_depth.shape[0] * behind_depth.shape[1], relief_height, relief, view, behind_depth)
