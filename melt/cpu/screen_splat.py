"""CPU twin of `melt.reference.screen_splat`.

Each thread draws all spheres into its own bands of rows, so that no pixel has two writers. Neighbouring bands go to
different threads: liquid often fills one half of the picture only.
"""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.physics.screen import entry, pierce

BANDS, SPREAD = 32, 13  # odd: every band comes once
LANES = 16


@cpu_stage
def screen_project(position, screen_radius, view, screen_sphere, screen_box, screen_skipped):
    """See `melt.reference.screen_splat.screen_project`."""
    real = screen_sphere.dtype.type
    n, pieces, none = position.shape[1], screen_skipped.shape[0], real(np.inf)
    for p in prange(pieces):
        skipped = np.int32(0)
        for i in range(p * n // pieces, (p + 1) * n // pieces):
            r = screen_radius[i]
            X, Y, Z = real(position[0, i] - view.eye_x), real(position[1, i] - view.eye_y), real(position[2, i] - view.eye_z)
            if view.below == 1:
                Z -= r
            x = X * view.right_x + Y * view.right_y + Z * view.right_z
            y = X * view.down_x + Y * view.down_y + Z * view.down_z
            z = X * view.forward_x + Y * view.forward_y + Z * view.forward_z
            # by comparisons: isfinite(x) tests x - x, which the flag `reassoc` cancels where x is a difference
            finite = abs(X) < none and abs(Y) < none and abs(Z) < none and abs(r) < none
            skipped += np.int32(0) if finite else np.int32(1)
            wide = max(r, view.smallest * z / view.focal)
            seen = finite and r > real(0) and z > real(1.01) * wide and z + wide < view.far
            screen_sphere[0, i] = x if seen else real(0)
            screen_sphere[1, i] = y if seen else real(0)
            screen_sphere[2, i] = z if seen else real(0)
            screen_sphere[3, i] = wide if seen else real(0)
            # tangents to the circle (x, z; r) from the eye
            per = view.focal / (z * z - wide * wide)
            s, t = wide * math.sqrt(x * x + z * z - wide * wide), wide * math.sqrt(y * y + z * z - wide * wide)
            screen_box[0, i] = view.centre_x + per * (x * z - s) if seen else real(0)
            screen_box[1, i] = view.centre_x + per * (x * z + s) if seen else real(-1)
            screen_box[2, i] = view.centre_y + per * (y * z - t) if seen else real(0)
            screen_box[3, i] = view.centre_y + per * (y * z + t) if seen else real(-1)
        screen_skipped[p] = skipped


@cpu_helper
def _covered(low, high, first, last):
    """Return the pixels (from, to) of first .. last whose centres lie between low and high; to >= from."""
    half = type(low)(0.5)
    start = max(first, int(math.ceil(low - half)))
    return start, max(start, min(last, int(math.floor(high - half)) + 1))


@cpu_stage
def screen_depth(screen_sphere, screen_box, behind_depth, view, screen_depth):
    """See `melt.reference.screen_splat.screen_depth`."""
    real = screen_sphere.dtype.type
    height, width = screen_depth.shape
    per, none, zero, half = real(1) / view.focal, real(np.inf), real(0), real(0.5)
    for piece in prange(BANDS):
        band = piece * SPREAD % BANDS
        first, last = band * height // BANDS, (band + 1) * height // BANDS
        # whole groups of lanes, also where a disc ends within one: the loop over lanes has a fixed length
        nearest = np.full((last - first, width + LANES), none, screen_depth.dtype)
        for i in range(screen_sphere.shape[1]):
            if screen_box[3, i] < real(first) or screen_box[2, i] > real(last):
                continue
            top, bottom = _covered(screen_box[2, i], screen_box[3, i], first, last)
            left, right = _covered(screen_box[0, i], screen_box[1, i], 0, width)
            z, radius = screen_sphere[2, i], screen_sphere[3, i]
            p, q, narrow = screen_sphere[0, i] / z, screen_sphere[1, i] / z, z * z / (radius * radius)
            for row in range(np.uint64(top - first), np.uint64(bottom - first)):
                b = (real(np.int64(row) + first) + half - view.centre_y) * per - q
                for column in range(np.uint64(left), np.uint64(right), np.uint64(LANES)):
                    start = (real(np.int64(column)) + half - view.centre_x) * per - p
                    for lane in range(np.uint64(LANES)):
                        a = start + real(np.int64(lane)) * per
                        share, inverse = pierce(a, b, p, q, narrow)
                        depth = entry(a, b, p, q, z, radius, max(share, zero), inverse)
                        old = nearest[row, column + lane]
                        nearest[row, column + lane] = min(old, depth) if share > zero else old
        for row in range(first, last):
            for column in range(width):
                depth = nearest[row - first, column]
                screen_depth[row, column] = depth if depth < behind_depth[row, column] else none


@cpu_helper
def _halved(image, first, last, width):
    """Return rows first .. last of half resolution, as `melt.reference._screen.halved` has them, LANES wider."""
    out = np.zeros((last - first, width + LANES), image.dtype)
    for row in range(first, last):
        line = image[min(2 * row, image.shape[0] - 1)]
        for column in range(width):
            out[row - first, column] = line[min(2 * column, image.shape[1] - 1)]
    return out


@cpu_stage
def screen_length(screen_sphere, screen_box, behind_depth, view, splat, screen_length, screen_length_sum):
    """See `melt.reference.screen_splat.screen_length`."""
    real = screen_sphere.dtype.type
    height, width = screen_length.shape
    per, two, half, one, zero = real(2) / view.focal, real(2), real(0.5), real(1), real(0)
    for piece in prange(BANDS):
        band = piece * SPREAD % BANDS
        first, last = band * height // BANDS, (band + 1) * height // BANDS
        sums = np.zeros((last - first, width + LANES), np.int32)
        behind = _halved(behind_depth, first, last, width)
        for i in range(screen_sphere.shape[1]):
            if screen_box[3, i] < two * real(first) or screen_box[2, i] > two * real(last):
                continue
            top, bottom = _covered(half * screen_box[2, i], half * screen_box[3, i], first, last)
            left, right = _covered(half * screen_box[0, i], half * screen_box[1, i], 0, width)
            z, radius = screen_sphere[2, i], screen_sphere[3, i]
            p, q, narrow = screen_sphere[0, i] / z, screen_sphere[1, i] / z, z * z / (radius * radius)
            for row in range(np.uint64(top - first), np.uint64(bottom - first)):
                b = (real(np.int64(row) + first) + half - half * view.centre_y) * per - q
                for column in range(np.uint64(left), np.uint64(right), np.uint64(LANES)):
                    start = (real(np.int64(column)) + half - half * view.centre_x) * per - p
                    for lane in range(np.uint64(LANES)):
                        a = start + real(np.int64(lane)) * per
                        share, inverse = pierce(a, b, p, q, narrow)
                        share = max(share, zero)
                        room = behind[row, column + lane] - entry(a, b, p, q, z, radius, share, inverse)
                        length = min(max(room, zero) * math.sqrt(one / inverse), two * radius * math.sqrt(share))
                        sums[row, column + lane] += np.int32(length * splat.length_steps + half)
        for row in range(first, last):
            for column in range(width):
                screen_length[row, column] = real(sums[row - first, column]) / splat.length_steps
                screen_length_sum[row, column] = sums[row - first, column]


@cpu_stage
def screen_column(screen_depth, behind_depth, view, longest, screen_length):
    """See `melt.reference.screen_splat.screen_column`."""
    real = screen_depth.dtype.type
    height, width = screen_length.shape
    per, half, none = real(1) / view.focal, real(0.5), real(np.inf)
    for row in prange(height):
        r = min(2 * row, screen_depth.shape[0] - 1)
        v = (real(r) + half - view.centre_y) * per
        for column in range(width):
            c = min(2 * column, screen_depth.shape[1] - 1)
            u, depth = (real(c) + half - view.centre_x) * per, screen_depth[r, c]
            way = (behind_depth[r, c] - depth) * math.sqrt(u * u + v * v + real(1))
            screen_length[row, column] = min(max(way, real(0)), longest) if depth < none else real(0)


@cpu_stage
def screen_value(
    screen_sphere, screen_box, particle_value, screen_depth, view, splat, screen_value, screen_value_sum
):
    """See `melt.reference.screen_splat.screen_value`."""
    real = screen_sphere.dtype.type
    height, width = screen_value.shape[1:]
    per, two, half, one, zero = real(2) / view.focal, real(2), real(0.5), real(1), real(0)
    for piece in prange(BANDS):
        band = piece * SPREAD % BANDS
        first, last = band * height // BANDS, (band + 1) * height // BANDS
        sums = np.zeros((2, last - first, width + LANES), np.int32)
        per_reach, surface = one / splat.reach, _halved(screen_depth, first, last, width)
        for i in range(screen_sphere.shape[1]):
            if screen_box[3, i] < two * real(first) or screen_box[2, i] > two * real(last):
                continue
            top, bottom = _covered(half * screen_box[2, i], half * screen_box[3, i], first, last)
            left, right = _covered(half * screen_box[0, i], half * screen_box[1, i], 0, width)
            z, radius = screen_sphere[2, i], screen_sphere[3, i]
            p, q, narrow = screen_sphere[0, i] / z, screen_sphere[1, i] / z, z * z / (radius * radius)
            for row in range(np.uint64(top - first), np.uint64(bottom - first)):
                b = (real(np.int64(row) + first) + half - half * view.centre_y) * per - q
                for column in range(np.uint64(left), np.uint64(right), np.uint64(LANES)):
                    start = (real(np.int64(column)) + half - half * view.centre_x) * per - p
                    for lane in range(np.uint64(LANES)):
                        a = start + real(np.int64(lane)) * per
                        share, inverse = pierce(a, b, p, q, narrow)
                        inside = max(share, zero)
                        depth = entry(a, b, p, q, z, radius, inside, inverse)
                        near = min(max(one - (depth - surface[row, column + lane]) * per_reach, zero), one)
                        weight = (real(0.1) + real(0.9) * inside) * near if share > zero else zero
                        sums[0, row, column + lane] += np.int32(weight * splat.value_steps * particle_value[i] + half)
                        sums[1, row, column + lane] += np.int32(weight * splat.value_steps + half)
        for row in range(first, last):
            for column in range(width):
                value, weight = sums[0, row - first, column], sums[1, row - first, column]
                screen_value[0, row, column] = real(value) / splat.value_steps
                screen_value[1, row, column] = real(weight) / splat.value_steps
                screen_value_sum[0, row, column], screen_value_sum[1, row, column] = value, weight
