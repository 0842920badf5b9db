"""Compiled drawing: spheres and triangles into depth buffers.

The picture is cut into bands of rows; each thread draws all shapes into its own bands, in
their order, so that pictures are the same for any number of threads.
"""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange

BANDS = 32


@cpu_helper
def disc(x, y, z, radius, focal, centre_x, centre_y):
    """Return the middle and the radius [pixels] of what is seen of a sphere at (x, y, z) in the camera frame."""
    return x / z * focal + centre_x, y / z * focal + centre_y, max(radius / z * focal, np.float32(0.75))


@cpu_helper
def reach(middle, size, low, high):
    """Return the first pixel within ``size`` of ``middle``, and that after the last, of those from ``low`` on and below ``high``."""
    return max(low, int(math.floor(middle - size))), min(high, int(math.ceil(middle + size)) + 1)


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
            x, y, size = disc(centre[i, 0], centre[i, 1], z, radius[i], focal, centre_x, centre_y)
            (top, bottom), (west, east) = reach(y, size, first, last), reach(x, size, 0, width)
            for row in range(top, bottom):
                v = (row + np.float32(0.5) - y) / size
                for column in range(west, east):
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
            x, y, size = disc(centre[i, 0], centre[i, 1], z, radius[i], focal, centre_x, centre_y)
            (top, bottom), (west, east) = reach(y, size, first, last), reach(x, size, 0, width)
            for row in range(top, bottom):
                v = (row + np.float32(0.5) - y) / size
                for column in range(west, east):
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


@cpu_stage
def bubbles(centre, radius, focal, centre_x, centre_y, near, far, tint, light, half, up, dim, last, picture):
    """Blend gas bubbles into a picture, in their order (back to front): bright above, dark below, clear in the middle.

    A ray that meets the wall of a bubble in water at more than the critical angle (sine 0.75) is thrown back whole:
    the outer half of the disc mirrors the surroundings, sky above and liquid below.

    centre (n, 3), radius (n,) as `spheres`; drawn where near <= depth < far (height, width). tint (height, width, 3):
    colour of the liquid; light, half, up (3,): directions in the camera frame; dim [1/m]: what liquid takes away.
    last (height, width): depth of what was drawn last, 0 without liquid; picture (height, width, 3). Both are read
    and written.
    """
    height, width = near.shape
    one, two = np.float32(1), np.float32(2)
    for band in prange(BANDS):
        first, end = band * height // BANDS, (band + 1) * height // BANDS
        for i in range(centre.shape[0]):
            z = centre[i, 2]
            if z <= radius[i]:
                continue
            x, y, size = disc(centre[i, 0], centre[i, 1], z, radius[i], focal, centre_x, centre_y)
            (top, bottom), (west, east) = reach(y, size, first, end), reach(x, size, 0, width)
            for row in range(top, bottom):
                v = (row + np.float32(0.5) - y) / size
                for column in range(west, east):
                    u = (column + np.float32(0.5) - x) / size
                    left = one - u * u - v * v
                    if left <= 0:
                        continue
                    f = math.sqrt(left)
                    front = z - radius[i] * f
                    if front < near[row, column] or front >= far[row, column]:
                        continue
                    path = max(last[row, column] - (z + radius[i] * f), np.float32(0)) * dim
                    kept = np.float32(0.3) + np.float32(0.7) * math.exp(-path)
                    rim = min(max((math.sqrt(one - left) - np.float32(0.5)) * np.float32(2.2), np.float32(0)), one)
                    mirror = np.float32(0.06) + np.float32(0.86) * rim * rim * (np.float32(3) - two * rim)
                    # the ray (0, 0, 1) thrown back by the normal (u, v, -f)
                    sky = two * f * (u * up[0] + v * up[1]) + (one - two * left) * up[2]
                    sky = min(max(np.float32(0.5) + np.float32(0.8) * sky, np.float32(0)), one)
                    glint = max(u * half[0] + v * half[1] - f * half[2], np.float32(0)) ** 48
                    glow = max(-(u * light[0] + v * light[1]), np.float32(0)) ** 3 * np.float32(0.14)
                    for k in range(3):
                        t = tint[row, column, k] if last[row, column] > 0 else np.float32(0.8)
                        back = picture[row, column, k]
                        back = back * kept * (kept + (one - kept) * t) + np.float32(0.85) * t * (one - kept)
                        seen = np.float32(0.35) * t * (one - sky) + sky
                        picture[row, column, k] = back * (one - mirror) + seen * mirror + glint + glow
                    last[row, column] = front if last[row, column] > 0 else np.float32(0)


@cpu_stage
def puffs(centre, radius, focal, centre_x, centre_y, far, up, total, bright):
    """Add up soft balls in front of ``far``: density of the ray, and the same weighted by light from above.

    centre (n, 3), radius (n,) as `spheres`; up: sign of the picture's upward direction; total and bright
    (height, width) are read and written; a ray through the middle of a ball adds 1.
    """
    height, width = far.shape
    for band in prange(BANDS):
        first, last = band * height // BANDS, (band + 1) * height // BANDS
        for i in range(centre.shape[0]):
            z = centre[i, 2]
            if z <= radius[i]:
                continue
            x, y, size = disc(centre[i, 0], centre[i, 1], z, radius[i], focal, centre_x, centre_y)
            (top, bottom), (west, east) = reach(y, size, first, last), reach(x, size, 0, width)
            for row in range(top, bottom):
                v = (row + np.float32(0.5) - y) / size
                for column in range(west, east):
                    u = (column + np.float32(0.5) - x) / size
                    left = np.float32(1) - u * u - v * v
                    if left > 0 and z < far[row, column]:
                        dense = left * left
                        total[row, column] += dense
                        bright[row, column] += dense * (np.float32(0.5) - np.float32(0.5) * v * up)


@cpu_stage
def to_bytes(planes, out):
    """Write colours (3, height, width), 0 to 1, as bytes (height, width, 3); what exceeds the range is cut off."""
    real = planes.dtype.type
    height, width = out.shape[:2]
    for row in prange(height):
        for column in range(width):
            for k in range(3):
                out[row, column, k] = np.uint8(min(max(planes[k, row, column], real(0)), real(1)) * real(255) + real(0.5))
