"""Compiled drawing: spheres and triangles into depth buffers.

The picture is cut into bands of rows; each thread draws all shapes into its own bands, in
their order, so that pictures are the same for any number of threads.
"""

import math

import numpy as np

from melt._compile import cpu_stage, prange

BANDS = 32


@cpu_stage
def spheres(centre, radius, focal, centre_x, centre_y, depth, index):
    """Draw spheres: the front-most one of every pixel, and the depth of its surface.

    centre (n, 3) in the camera frame [m], radius (n,) [m]; depth (height, width), index likewise,
    are read and written.
    """
    height, width = depth.shape
    for band in prange(BANDS):
        first, last = band * height // BANDS, (band + 1) * height // BANDS
        for i in range(centre.shape[0]):
            z = centre[i, 2]
            if z <= radius[i]:
                continue
            x, y = centre[i, 0] / z * focal + centre_x, centre[i, 1] / z * focal + centre_y
            size = max(radius[i] / z * focal, np.float32(0.75))
            for row in range(max(first, int(math.floor(y - size))), min(last, int(math.ceil(y + size)) + 1)):
                v = (row + np.float32(0.5) - y) / size
                for column in range(
                    max(0, int(math.floor(x - size))), min(width, int(math.ceil(x + size)) + 1)
                ):
                    u = (column + np.float32(0.5) - x) / size
                    left = np.float32(1) - u * u - v * v
                    if left <= 0:
                        continue
                    surface = z - radius[i] * math.sqrt(left)
                    if surface < depth[row, column]:
                        depth[row, column] = surface
                        index[row, column] = i


@cpu_stage
def thickness(centre, radius, focal, centre_x, centre_y, depth, total):
    """Add up, in every pixel, the lengths of rays in spheres that lie in front of ``depth``."""
    height, width = depth.shape
    for band in prange(BANDS):
        first, last = band * height // BANDS, (band + 1) * height // BANDS
        for i in range(centre.shape[0]):
            z = centre[i, 2]
            if z <= radius[i]:
                continue
            x, y = centre[i, 0] / z * focal + centre_x, centre[i, 1] / z * focal + centre_y
            size = max(radius[i] / z * focal, np.float32(0.75))
            for row in range(max(first, int(math.floor(y - size))), min(last, int(math.ceil(y + size)) + 1)):
                v = (row + np.float32(0.5) - y) / size
                for column in range(
                    max(0, int(math.floor(x - size))), min(width, int(math.ceil(x + size)) + 1)
                ):
                    u = (column + np.float32(0.5) - x) / size
                    left = np.float32(1) - u * u - v * v
                    if left > 0 and z < depth[row, column]:
                        total[row, column] += np.float32(2) * radius[i] * math.sqrt(left)


@cpu_stage
def triangles(corner, value, behind, depth, total, out):
    """Draw triangles with smooth corner values, and the length of rays inside the closed mesh.

    corner (f, 3, 3): pixel x, pixel y, 1/z; value (f, 3, c); behind (height, width): depth of what
    hides the mesh. depth (height, width) and out (height, width, c) get the front-most triangle;
    total (height, width) the length along z: exit depths less entry depths, each at most ``behind``.
    """
    height, width = depth.shape
    for band in prange(BANDS):
        first, last = band * height // BANDS, (band + 1) * height // BANDS
        for i in range(corner.shape[0]):
            x0, y0, w0 = corner[i, 0, 0], corner[i, 0, 1], corner[i, 0, 2]
            x1, y1, w1 = corner[i, 1, 0], corner[i, 1, 1], corner[i, 1, 2]
            x2, y2, w2 = corner[i, 2, 0], corner[i, 2, 1], corner[i, 2, 2]
            if w0 <= 0 or w1 <= 0 or w2 <= 0:
                continue
            area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
            if area == 0:
                continue
            top, bottom = min(y0, y1, y2), max(y0, y1, y2)
            left, right = min(x0, x1, x2), max(x0, x1, x2)
            for row in range(max(first, int(math.floor(top))), min(last, int(math.ceil(bottom)) + 1)):
                y = row + 0.5
                for column in range(max(0, int(math.floor(left))), min(width, int(math.ceil(right)) + 1)):
                    x = column + 0.5
                    a = ((x1 - x) * (y2 - y) - (x2 - x) * (y1 - y)) / area
                    b = ((x2 - x) * (y0 - y) - (x0 - x) * (y2 - y)) / area
                    c = 1.0 - a - b
                    if a < 0 or b < 0 or c < 0:
                        continue
                    w = a * w0 + b * w1 + c * w2
                    z = 1.0 / w
                    # a front face of a mesh with outward winding runs clockwise in pixels (y down)
                    clipped = min(z, behind[row, column])
                    total[row, column] += clipped if area < 0 else -clipped
                    if z < depth[row, column]:
                        depth[row, column] = z
                        for k in range(value.shape[2]):
                            out[row, column, k] = (
                                a * w0 * value[i, 0, k] + b * w1 * value[i, 1, k] + c * w2 * value[i, 2, k]
                            ) * z
