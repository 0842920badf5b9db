"""CUDA twin of `melt.reference.screen_smooth`."""

import math

from melt._compile import cuda, cuda_kernel
from melt.physics.screen import decay, window


@cuda_kernel
def _bilateral(screen_depth, filter, view, rows, columns, screen_depth_next):
    """Rows and columns: 1 if the window extends over them, 0 if it is one pixel wide there."""
    k = cuda.grid(1)
    height, width = screen_depth.shape
    if k >= height * width:
        return
    real = screen_depth.dtype.type
    row, column = k // width, k % width
    none, centre = real(math.inf), screen_depth[row, column]
    if not centre < none:
        screen_depth_next[row, column] = none
        return
    spread = window(centre, filter.size, view.focal, filter.smallest, filter.largest)
    sharp = real(0.5) / (filter.range * filter.range)
    reach = int(math.sqrt(real(3.125) / spread)) + 1
    total, weight = real(0), real(0)
    for r in range(max(row - reach * rows, 0), min(row + reach * rows, height - 1) + 1):
        for c in range(max(column - reach * columns, 0), min(column + reach * columns, width - 1) + 1):
            x = real((r - row) * (r - row) + (c - column) * (c - column)) * spread
            depth = screen_depth[r, c]
            if x <= real(3.125) and depth < none:  # 2.5^2/2: exponent of the window where it ends
                gap = depth - centre
                w = decay(x + gap * gap * sharp)
                total += w * gap
                weight += w
    screen_depth_next[row, column] = centre + total / weight


def bilateral(screen_depth, filter, view, screen_depth_next):
    """See `melt.reference.screen_smooth.bilateral`."""
    pixels = screen_depth.shape[0] * screen_depth.shape[1]
    _bilateral.launch(pixels, screen_depth, filter, view, 1, 1, screen_depth_next)


def bilateral_pass(screen_depth, filter, view, along, screen_depth_next):
    """See `melt.reference.screen_smooth.bilateral_pass`."""
    pixels, down = screen_depth.shape[0] * screen_depth.shape[1], int(along)
    _bilateral.launch(pixels, screen_depth, filter, view, down, 1 - down, screen_depth_next)


@cuda_kernel
def _narrow_pass(screen_depth, filter, view, along, screen_depth_next):
    t = cuda.grid(1)
    height, width = screen_depth.shape
    if t >= height * width:
        return
    real = screen_depth.dtype.type
    row, column = t // width, t % width
    none, centre = real(math.inf), screen_depth[row, column]
    if not centre < none:
        screen_depth_next[row, column] = none
        return
    down, right = (1, 0) if along == 1 else (0, 1)
    total, weight = real(0), real(1)
    low, high = centre - filter.narrow, centre + filter.narrow
    spread = window(centre, filter.size, view.focal, filter.smallest, filter.largest)
    room = min(row, height - 1 - row) if along == 1 else min(column, width - 1 - column)
    w, rate = real(1), math.exp(-spread)
    square, k = rate * rate, 1
    while k <= room and real(k * k) * spread <= real(3.125):
        w, rate = w * rate, rate * square  # g^(k^2)
        one, two = screen_depth[row - k * down, column - k * right], screen_depth[row + k * down, column + k * right]
        near, far = min(one, two), max(one, two)
        if near >= low and far < none:
            total += w * ((near - centre if near <= high else filter.clamp) + (far - centre if far <= high else filter.clamp))
            weight += w + w
            if near <= high:
                low = min(low, near - filter.narrow)
                high = max(high, (far if far <= high else near) + filter.narrow)
        k += 1
    screen_depth_next[row, column] = centre + total / weight


def narrow_pass(screen_depth, filter, view, along, screen_depth_next):
    """See `melt.reference.screen_smooth.narrow_pass`."""
    _narrow_pass.launch(screen_depth.shape[0] * screen_depth.shape[1], screen_depth, filter, view, along, screen_depth_next)


@cuda_kernel
def _screen_blur(screen_length, deviation, along, screen_length_next):
    t = cuda.grid(1)
    height, width = screen_length.shape
    if t >= height * width:
        return
    real = screen_length.dtype.type
    row, column = t // width, t % width
    down, right = (1, 0) if along == 1 else (0, 1)
    total, weight, spread = screen_length[row, column], real(1), real(0.5) / (deviation * deviation)
    for k in range(1, int(real(2.5) * deviation) + 1):
        w = decay(real(k * k) * spread)
        one = screen_length[max(row - k * down, 0), max(column - k * right, 0)]
        two = screen_length[min(row + k * down, height - 1), min(column + k * right, width - 1)]
        total += w * (one + two)
        weight += w + w
    screen_length_next[row, column] = total / weight


def screen_blur(screen_length, deviation, along, screen_length_next):
    """See `melt.reference.screen_smooth.screen_blur`."""
    _screen_blur.launch(screen_length.shape[0] * screen_length.shape[1], screen_length, deviation, along, screen_length_next)
