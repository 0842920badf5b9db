"""CUDA twin of `melt.reference.screen_splat`.

One thread a sphere. Depths are kept as integers while spheres compete for them, because an integer minimum does not
depend on the order: fixed point with a power of two, which holds every float32 between far/64 and far exactly. Sums
are in fixed point for the same reason.
"""

import math

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.physics.screen import entry, pierce


@cuda_kernel
def _screen_project(position, screen_radius, view, screen_sphere, screen_box):
    i = cuda.grid(1)
    if i >= position.shape[1]:
        return
    real = screen_sphere.dtype.type
    r = screen_radius[i]
    X, Y, Z = real(position[0, i] - view.eye_x), real(position[1, i] - view.eye_y), real(position[2, i] - view.eye_z)
    if view.below == 1:
        Z -= r
    x = X * view.right_x + Y * view.right_y + Z * view.right_z
    y = X * view.down_x + Y * view.down_y + Z * view.down_z
    z = X * view.forward_x + Y * view.forward_y + Z * view.forward_z
    wide = max(r, view.smallest * z / view.focal)
    finite = math.isfinite(X) and math.isfinite(Y) and math.isfinite(Z) and math.isfinite(r)
    if not (finite and r > real(0) and z > real(1.01) * wide and z + wide < view.far):
        screen_sphere[0, i] = screen_sphere[1, i] = screen_sphere[2, i] = screen_sphere[3, i] = real(0)
        screen_box[0, i] = screen_box[2, i] = real(0)
        screen_box[1, i] = screen_box[3, i] = real(-1)
        return
    screen_sphere[0, i], screen_sphere[1, i], screen_sphere[2, i], screen_sphere[3, i] = x, y, z, wide
    # tangents to the circle (x, z; r) from the eye
    per = view.focal / (z * z - wide * wide)
    s, t = wide * math.sqrt(x * x + z * z - wide * wide), wide * math.sqrt(y * y + z * z - wide * wide)
    screen_box[0, i], screen_box[1, i] = view.centre_x + per * (x * z - s), view.centre_x + per * (x * z + s)
    screen_box[2, i], screen_box[3, i] = view.centre_y + per * (y * z - t), view.centre_y + per * (y * z + t)


@cuda_kernel
def _screen_skipped(position, screen_radius, screen_skipped):
    p = cuda.grid(1)
    n, pieces = position.shape[1], screen_skipped.shape[0]
    if p >= pieces:
        return
    skipped = 0
    for i in range(p * n // pieces, (p + 1) * n // pieces):
        finite = math.isfinite(position[0, i]) and math.isfinite(position[1, i]) and math.isfinite(position[2, i])
        if not (finite and math.isfinite(screen_radius[i])):
            skipped += 1
    screen_skipped[p] = skipped


def screen_project(position, screen_radius, view, screen_sphere, screen_box, screen_skipped):
    """See `melt.reference.screen_splat.screen_project`."""
    _screen_project.launch(position.shape[1], position, screen_radius, view, screen_sphere, screen_box)
    _screen_skipped.launch(screen_skipped.shape[0], position, screen_radius, screen_skipped)


@cuda_kernel
def _fill(image, value):
    k = cuda.grid(1)
    if k < image.shape[0] * image.shape[1]:
        image[k // image.shape[1], k % image.shape[1]] = value


@cuda_kernel
def _nearest(screen_sphere, screen_box, behind_depth, view, steps, key):
    i = cuda.grid(1)
    if i >= screen_sphere.shape[1] or screen_box[1, i] < screen_box[0, i]:
        return
    real, whole = screen_sphere.dtype.type, key.dtype.type
    height, width = key.shape
    half, per = real(0.5), real(1) / view.focal
    z, radius = screen_sphere[2, i], screen_sphere[3, i]
    p, q, narrow = screen_sphere[0, i] / z, screen_sphere[1, i] / z, z * z / (radius * radius)
    top, bottom = max(0, int(math.ceil(screen_box[2, i] - half))), min(height, int(math.floor(screen_box[3, i] - half)) + 1)
    left, right = max(0, int(math.ceil(screen_box[0, i] - half))), min(width, int(math.floor(screen_box[1, i] - half)) + 1)
    for row in range(top, bottom):
        b = (real(row) + half - view.centre_y) * per - q
        for column in range(left, right):
            a = (real(column) + half - view.centre_x) * per - p
            share, inverse = pierce(a, b, p, q, narrow)
            depth = entry(a, b, p, q, z, radius, max(share, real(0)), inverse)
            if share > real(0) and depth < behind_depth[row, column]:
                cuda.atomic.min(key, (row, column), whole(depth * steps))


@cuda_kernel
def _depth_of(key, steps, most, screen_depth):
    k = cuda.grid(1)
    height, width = screen_depth.shape
    if k >= height * width:
        return
    real = screen_depth.dtype.type
    row, column = k // width, k % width
    got = key[row, column]
    screen_depth[row, column] = real(got) / steps if got < most else real(math.inf)


def screen_depth(screen_sphere, screen_box, behind_depth, view, screen_depth):
    """See `melt.reference.screen_splat.screen_depth`."""
    real = type(view.far)
    whole, bits = (np.int32, 30) if real == np.float32 else (np.int64, 62)
    key = screen_depth.view(whole)  # in the same memory: the last kernel turns each integer into the depth it stands for
    pixels, most, steps = screen_depth.shape[0] * screen_depth.shape[1], whole(2**bits), real(2.0**bits) / view.far
    _fill.launch(pixels, key, most)
    _nearest.launch(screen_sphere.shape[1], screen_sphere, screen_box, behind_depth, view, steps, key)
    _depth_of.launch(pixels, key, steps, most, screen_depth)


@cuda_kernel
def _lengths(screen_sphere, screen_box, behind_depth, view, splat, screen_length_sum):
    i = cuda.grid(1)
    if i >= screen_sphere.shape[1] or screen_box[1, i] < screen_box[0, i]:
        return
    real = screen_sphere.dtype.type
    height, width = screen_length_sum.shape
    half, per = real(0.5), real(2) / view.focal
    z, radius = screen_sphere[2, i], screen_sphere[3, i]
    p, q, narrow = screen_sphere[0, i] / z, screen_sphere[1, i] / z, z * z / (radius * radius)
    top, bottom = max(0, int(math.ceil(half * screen_box[2, i] - half))), min(height, int(math.floor(half * screen_box[3, i] - half)) + 1)
    left, right = max(0, int(math.ceil(half * screen_box[0, i] - half))), min(width, int(math.floor(half * screen_box[1, i] - half)) + 1)
    for row in range(top, bottom):
        b = (real(row) + half - half * view.centre_y) * per - q
        for column in range(left, right):
            a = (real(column) + half - half * view.centre_x) * per - p
            share, inverse = pierce(a, b, p, q, narrow)
            if share > real(0):
                behind = behind_depth[min(2 * row, behind_depth.shape[0] - 1), min(2 * column, behind_depth.shape[1] - 1)]
                room = behind - entry(a, b, p, q, z, radius, share, inverse)
                length = min(max(room, real(0)) * math.sqrt(real(1) / inverse), real(2) * radius * math.sqrt(share))
                cuda.atomic.add(screen_length_sum, (row, column), np.int32(length * splat.length_steps + half))


@cuda_kernel
def _from_steps(sums, steps, image):
    k = cuda.grid(1)
    height, width = image.shape
    if k < height * width:
        image[k // width, k % width] = image.dtype.type(sums[k // width, k % width]) / steps


def screen_length(screen_sphere, screen_box, behind_depth, view, splat, screen_length, screen_length_sum):
    """See `melt.reference.screen_splat.screen_length`."""
    pixels = screen_length.shape[0] * screen_length.shape[1]
    _fill.launch(pixels, screen_length_sum, np.int32(0))
    _lengths.launch(screen_sphere.shape[1], screen_sphere, screen_box, behind_depth, view, splat, screen_length_sum)
    _from_steps.launch(pixels, screen_length_sum, splat.length_steps, screen_length)


@cuda_kernel
def _screen_column(screen_depth, behind_depth, view, longest, screen_length):
    k = cuda.grid(1)
    height, width = screen_length.shape
    if k >= height * width:
        return
    real = screen_depth.dtype.type
    half, per = real(0.5), real(1) / view.focal
    r, c = min(2 * (k // width), screen_depth.shape[0] - 1), min(2 * (k % width), screen_depth.shape[1] - 1)
    u, v, depth = (real(c) + half - view.centre_x) * per, (real(r) + half - view.centre_y) * per, screen_depth[r, c]
    way = (behind_depth[r, c] - depth) * math.sqrt(u * u + v * v + real(1))
    screen_length[k // width, k % width] = min(max(way, real(0)), longest) if depth < real(math.inf) else real(0)


def screen_column(screen_depth, behind_depth, view, longest, screen_length):
    """See `melt.reference.screen_splat.screen_column`."""
    pixels = screen_length.shape[0] * screen_length.shape[1]
    _screen_column.launch(pixels, screen_depth, behind_depth, view, longest, screen_length)


@cuda_kernel
def _values(screen_sphere, screen_box, particle_value, screen_depth, view, splat, value_sum, weight_sum):
    i = cuda.grid(1)
    if i >= screen_sphere.shape[1] or screen_box[1, i] < screen_box[0, i]:
        return
    real = screen_sphere.dtype.type
    height, width = value_sum.shape
    half, per = real(0.5), real(2) / view.focal
    z, radius = screen_sphere[2, i], screen_sphere[3, i]
    p, q, narrow = screen_sphere[0, i] / z, screen_sphere[1, i] / z, z * z / (radius * radius)
    top, bottom = max(0, int(math.ceil(half * screen_box[2, i] - half))), min(height, int(math.floor(half * screen_box[3, i] - half)) + 1)
    left, right = max(0, int(math.ceil(half * screen_box[0, i] - half))), min(width, int(math.floor(half * screen_box[1, i] - half)) + 1)
    for row in range(top, bottom):
        b = (real(row) + half - half * view.centre_y) * per - q
        for column in range(left, right):
            a = (real(column) + half - half * view.centre_x) * per - p
            share, inverse = pierce(a, b, p, q, narrow)
            if share > real(0):
                surface = screen_depth[min(2 * row, screen_depth.shape[0] - 1), min(2 * column, screen_depth.shape[1] - 1)]
                near = real(1) - (entry(a, b, p, q, z, radius, share, inverse) - surface) / splat.reach
                weight = (real(0.1) + real(0.9) * share) * min(max(near, real(0)), real(1)) * splat.value_steps
                cuda.atomic.add(value_sum, (row, column), np.int32(weight * particle_value[i] + half))
                cuda.atomic.add(weight_sum, (row, column), np.int32(weight + half))


def screen_value(
    screen_sphere, screen_box, particle_value, screen_depth, view, splat, screen_value, screen_value_sum
):
    """See `melt.reference.screen_splat.screen_value`."""
    pixels = screen_value.shape[1] * screen_value.shape[2]
    for k in range(2):
        _fill.launch(pixels, screen_value_sum[k], np.int32(0))
    _values.launch(
        screen_sphere.shape[1], screen_sphere, screen_box, particle_value, screen_depth, view, splat,
        screen_value_sum[0], screen_value_sum[1],
    )
    for k in range(2):
        _from_steps.launch(pixels, screen_value_sum[k], splat.value_steps, screen_value[k])
