"""CPU twin of `melt.reference.screen_splat`.

Each thread draws all spheres into its own bands of rows, so that no pixel has two writers. Neighbouring bands go to
different threads: liquid often fills one half of the picture only.
"""

import math

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.physics.screen import pierce

BANDS, SPREAD = 32, 13  # odd: every band comes once
LANES = 16


@cpu_stage
def screen_project(position, screen_radius, view, screen_sphere, screen_box, screen_skipped):
    """See `melt.reference.screen_splat.screen_project`."""
    real = screen_sphere.dtype.type
    n, pieces = position.shape[1], screen_skipped.shape[0]
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
            finite = math.isfinite(X) and math.isfinite(Y) and math.isfinite(Z) and math.isfinite(r)
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
    """Return the pixels (from, to) of first .. last whose centres lie between low and high."""
    half = type(low)(0.5)
    return max(first, int(math.ceil(low - half))), min(last, int(math.floor(high - half)) + 1)


@cpu_stage
def screen_depth(screen_sphere, screen_box, behind_depth, view, screen_depth):
    """See `melt.reference.screen_splat.screen_depth`."""
    real = screen_sphere.dtype.type
    height, width = screen_depth.shape
    per, none = real(1) / view.focal, real(np.inf)
    for piece in prange(BANDS):
        band = piece * SPREAD % BANDS
        first, last = band * height // BANDS, (band + 1) * height // BANDS
        # whole groups of lanes, also where a disc ends within one: the loop over lanes has a fixed length
        nearest = np.full((last - first, width + LANES), none, screen_depth.dtype)
        for i in range(screen_sphere.shape[1]):
            if screen_box[3, i] < first or screen_box[2, i] > last:
                continue
            top, bottom = _covered(screen_box[2, i], screen_box[3, i], first, last)
            left, right = _covered(screen_box[0, i], screen_box[1, i], 0, width)
            z, radius = screen_sphere[2, i], screen_sphere[3, i]
            p, q = screen_sphere[0, i] / z, screen_sphere[1, i] / z
            for row in range(np.uint64(max(top - first, 0)), np.uint64(max(bottom - first, 0))):
                b = (real(np.int64(row) + first) + real(0.5) - view.centre_y) * per - q
                for column in range(np.uint64(left), np.uint64(max(right, 0)), np.uint64(LANES)):
                    a0 = (real(np.int64(column)) + real(0.5) - view.centre_x) * per - p
                    for lane in range(np.uint64(LANES)):
                        depth, _, share = pierce(a0 + real(np.int64(lane)) * per, b, p, q, z, radius)
                        old = nearest[row, column + lane]
                        nearest[row, column + lane] = min(old, depth) if share > real(0) else old
        for row in range(first, last):
            for column in range(width):
                depth = nearest[row - first, column]
                screen_depth[row, column] = depth if depth < behind_depth[row, column] else none


@cpu_stage
def screen_length(screen_sphere, screen_box, behind_depth, view, splat, screen_length, screen_length_sum):
    """See `melt.reference.screen_splat.screen_length`."""
    real = screen_sphere.dtype.type
    height, width = screen_length.shape
    per, two, half = real(2) / view.focal, real(2), real(0.5)
    for piece in prange(BANDS):
        band = piece * SPREAD % BANDS
        first, last = band * height // BANDS, (band + 1) * height // BANDS
        screen_length_sum[first:last] = 0
        for i in range(screen_sphere.shape[1]):
            if screen_box[3, i] < two * real(first) or screen_box[2, i] > two * real(last):
                continue
            top, bottom = _covered(half * screen_box[2, i], half * screen_box[3, i], first, last)
            left, right = _covered(half * screen_box[0, i], half * screen_box[1, i], 0, width)
            z, radius = screen_sphere[2, i], screen_sphere[3, i]
            p, q = screen_sphere[0, i] / z, screen_sphere[1, i] / z
            for row in range(top, bottom):
                b = (real(row) + half - half * view.centre_y) * per - q
                behind = behind_depth[min(2 * row, behind_depth.shape[0] - 1)]
                for column in range(left, right):
                    a = (real(column) + half - half * view.centre_x) * per - p
                    depth, chord, share = pierce(a, b, p, q, z, radius)
                    u, v = p + a, q + b
                    room = (behind[min(2 * column, behind.shape[0] - 1)] - depth) * math.sqrt(u * u + v * v + real(1))
                    length = min(max(room, real(0)), chord) if share > real(0) else real(0)
                    screen_length_sum[row, column] += np.int32(length * splat.length_steps + half)
        for row in range(first, last):
            for column in range(width):
                screen_length[row, column] = real(screen_length_sum[row, column]) / splat.length_steps


@cpu_stage
def screen_value(
    screen_sphere, screen_box, particle_value, screen_depth, view, splat, screen_value, screen_value_sum
):
    """See `melt.reference.screen_splat.screen_value`."""
    real = screen_sphere.dtype.type
    height, width = screen_value.shape[1:]
    per, two, half = real(2) / view.focal, real(2), real(0.5)
    for piece in prange(BANDS):
        band = piece * SPREAD % BANDS
        first, last = band * height // BANDS, (band + 1) * height // BANDS
        screen_value_sum[:, first:last] = 0
        for i in range(screen_sphere.shape[1]):
            if screen_box[3, i] < two * real(first) or screen_box[2, i] > two * real(last):
                continue
            top, bottom = _covered(half * screen_box[2, i], half * screen_box[3, i], first, last)
            left, right = _covered(half * screen_box[0, i], half * screen_box[1, i], 0, width)
            z, radius = screen_sphere[2, i], screen_sphere[3, i]
            p, q = screen_sphere[0, i] / z, screen_sphere[1, i] / z
            for row in range(top, bottom):
                b = (real(row) + half - half * view.centre_y) * per - q
                surface = screen_depth[min(2 * row, screen_depth.shape[0] - 1)]
                for column in range(left, right):
                    a = (real(column) + half - half * view.centre_x) * per - p
                    depth, _, share = pierce(a, b, p, q, z, radius)
                    near = real(1) - (depth - surface[min(2 * column, surface.shape[0] - 1)]) / splat.reach
                    weight = (real(0.1) + real(0.9) * share) * min(max(near, real(0)), real(1))
                    weight = weight * splat.value_steps if share > real(0) else real(0)
                    screen_value_sum[0, row, column] += np.int32(weight * particle_value[i] + half)
                    screen_value_sum[1, row, column] += np.int32(weight + half)
        for row in range(first, last):
            for column in range(width):
                screen_value[0, row, column] = real(screen_value_sum[0, row, column]) / splat.value_steps
                screen_value[1, row, column] = real(screen_value_sum[1, row, column]) / splat.value_steps
