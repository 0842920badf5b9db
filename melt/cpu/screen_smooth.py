"""CPU twin of `melt.reference.screen_smooth`."""

import numpy as np

from melt._compile import cpu_helper, cpu_stage, prange
from melt.physics.screen import decay

CHUNKS, SPREAD = 64, 37  # odd: every chunk comes once, and neighbours go to different threads
LANES = 64
REACH2 = 3.125  # 2.5^2/2: exponent of the window where it ends


@cpu_helper
def _tap(k2, centre, other, filter, focal, total, weight):
    """Add one tap of the filter, at a squared distance of k2 pixels, to the sums of a group of lanes."""
    real = type(focal)
    none, sharp = real(np.inf), real(0.5) / (filter.range * filter.range)
    low, high = real(0.5) / (filter.largest * filter.largest), real(0.5) / (filter.smallest * filter.smallest)
    per = real(0.5) / (focal * filter.size * (focal * filter.size))
    for lane in range(centre.shape[0]):
        depth, far = centre[lane], other[lane]
        x = k2 * min(max(depth * depth * per, low), high)  # as `window`, whose division this spares
        some = x <= real(REACH2) and far < none
        gap = (far if some else depth) - depth
        w = decay(x + gap * gap * sharp) if some else real(0)
        total[lane] += w * gap if some else real(0)
        weight[lane] += w


@cpu_helper
def _farthest(centre, filter, focal):
    """Return how many pixels the widest window of a group of lanes reaches, -1 if there is no liquid."""
    real = type(focal)
    nearest = real(np.inf)
    for lane in range(centre.shape[0]):
        nearest = min(nearest, centre[lane])
    if nearest == real(np.inf):
        return -1
    return int(real(2.5) * min(max(focal * filter.size / nearest, filter.smallest), filter.largest))


@cpu_helper
def _finish(centre, total, weight, out):
    """Write the means of a group of lanes; without liquid they stay infinite."""
    one, none = type(centre[0])(1), type(centre[0])(np.inf)
    for lane in range(centre.shape[0]):
        out[lane] = centre[lane] + total[lane] / (one + weight[lane]) if centre[lane] < none else none


@cpu_stage
def bilateral(screen_depth, filter, view, screen_depth_next):
    """See `melt.reference.screen_smooth.bilateral`."""
    real = screen_depth.dtype.type
    height, width = screen_depth.shape
    margin = int(real(2.5) * filter.largest) + 1
    for piece in prange(CHUNKS):
        chunk = piece * SPREAD % CHUNKS
        first, last = chunk * height // CHUNKS, (chunk + 1) * height // CHUNKS
        padded = np.full((last - first + 2 * margin, width + 2 * margin), real(np.inf), screen_depth.dtype)
        for row in range(max(first - margin, 0), min(last + margin, height) if last > first else 0):
            padded[row - first + margin, margin : margin + width] = screen_depth[row]
        total, weight = np.empty(LANES, screen_depth.dtype), np.empty(LANES, screen_depth.dtype)
        for row in range(first, last):
            for c in range(0, width, LANES):
                end = min(c + LANES, width)
                centre = screen_depth[row, c:end]
                reach = _farthest(centre, filter, view.focal)
                total[:], weight[:] = real(0), real(0)
                for j in range(-reach, reach + 1):
                    line = padded[row - first + margin + j]
                    for k in range(-reach, reach + 1):
                        if j * j + k * k > 0 and j * j + k * k <= (reach + 1) * (reach + 1):
                            other = line[margin + c + k : margin + end + k]
                            _tap(real(j * j + k * k), centre, other, filter, view.focal, total, weight)
                _finish(centre, total, weight, screen_depth_next[row, c:end])


@cpu_stage
def bilateral_pass(screen_depth, filter, view, along, screen_depth_next):
    """See `melt.reference.screen_smooth.bilateral_pass`."""
    real = screen_depth.dtype.type
    height, width = screen_depth.shape
    margin = int(real(2.5) * filter.largest) + 1
    for piece in prange(CHUNKS):
        chunk = piece * SPREAD % CHUNKS
        line = np.full(width + 2 * margin, real(np.inf), screen_depth.dtype)
        total, weight = np.empty(LANES, screen_depth.dtype), np.empty(LANES, screen_depth.dtype)
        for row in range(chunk * height // CHUNKS, (chunk + 1) * height // CHUNKS):
            line[margin : margin + width] = screen_depth[row]
            for c in range(0, width, LANES):
                end = min(c + LANES, width)
                centre = screen_depth[row, c:end]
                total[:], weight[:] = real(0), real(0)
                for k in range(1, _farthest(centre, filter, view.focal) + 1):
                    k2 = real(k * k)
                    if along == 0:
                        _tap(k2, centre, line[margin + c - k : margin + end - k], filter, view.focal, total, weight)
                        _tap(k2, centre, line[margin + c + k : margin + end + k], filter, view.focal, total, weight)
                    else:
                        if row >= k:
                            _tap(k2, centre, screen_depth[row - k, c:end], filter, view.focal, total, weight)
                        if row + k < height:
                            _tap(k2, centre, screen_depth[row + k, c:end], filter, view.focal, total, weight)
                _finish(centre, total, weight, screen_depth_next[row, c:end])


@cpu_helper
def _pair(k2, centre, one, two, filter, focal, state):
    """Add a pair of taps of the narrow-range filter to the state of a group of lanes: sums, weights, low and high ends.

    One array holds the four, LANES apart: of separate ones, the compiler would have to prove that they do not overlap.
    """
    real = type(focal)
    none = real(np.inf)
    least, most = real(0.5) / (filter.largest * filter.largest), real(0.5) / (filter.smallest * filter.smallest)
    per = real(0.5) / (focal * filter.size * (focal * filter.size))
    for lane in range(np.uint64(centre.shape[0])):
        depth, near, far = centre[lane], min(one[lane], two[lane]), max(one[lane], two[lane])
        low, high = state[lane + np.uint64(2 * LANES)], state[lane + np.uint64(3 * LANES)]
        x = k2 * min(max(depth * depth * per, least), most)
        some, held, both = x <= real(REACH2) and near >= low and far < none, near <= high, far <= high
        w = decay(x) if some else real(0)
        first, second = near - depth if held else filter.clamp, far - depth if both else filter.clamp
        state[lane] += w * (first + second)
        state[lane + np.uint64(LANES)] += w + w
        state[lane + np.uint64(2 * LANES)] = min(low, near - filter.narrow) if some and held else low
        state[lane + np.uint64(3 * LANES)] = max(high, (far if both else near) + filter.narrow) if some and held else high


@cpu_stage
def narrow_pass(screen_depth, filter, view, along, screen_depth_next):
    """See `melt.reference.screen_smooth.narrow_pass`."""
    real = screen_depth.dtype.type
    height, width = screen_depth.shape
    margin, none = int(real(2.5) * filter.largest) + 1, real(np.inf)
    for piece in prange(CHUNKS):
        chunk = piece * SPREAD % CHUNKS
        line, state = np.full(width + 2 * margin, none, screen_depth.dtype), np.empty(4 * LANES, screen_depth.dtype)
        for row in range(chunk * height // CHUNKS, (chunk + 1) * height // CHUNKS):
            line[margin : margin + width] = screen_depth[row]
            for c in range(0, width, LANES):
                end = min(c + LANES, width)
                centre = screen_depth[row, c:end]
                for lane in range(end - c):
                    state[lane], state[LANES + lane] = real(0), real(1)
                    state[2 * LANES + lane], state[3 * LANES + lane] = centre[lane] - filter.narrow, centre[lane] + filter.narrow
                reach = _farthest(centre, filter, view.focal)
                if along == 1:
                    reach = min(reach, row, height - 1 - row)
                for k in range(1, reach + 1):
                    one, two = line[margin + c - k : margin + end - k], line[margin + c + k : margin + end + k]
                    if along == 1:
                        one, two = screen_depth[row - k, c:end], screen_depth[row + k, c:end]
                    _pair(real(k * k), centre, one, two, filter, view.focal, state)
                out = screen_depth_next[row, c:end]
                for lane in range(end - c):
                    out[lane] = centre[lane] + state[lane] / state[LANES + lane] if centre[lane] < none else none


@cpu_stage
def screen_blur(screen_length, deviation, along, screen_length_next):
    """See `melt.reference.screen_smooth.screen_blur`."""
    real = screen_length.dtype.type
    height, width = screen_length.shape
    reach, spread = int(real(2.5) * deviation), real(0.5) / (deviation * deviation)
    for piece in prange(CHUNKS):
        line = np.empty(width + 2 * reach, screen_length.dtype)
        for row in range(piece * height // CHUNKS, (piece + 1) * height // CHUNKS):
            line[reach : reach + width] = screen_length[row]
            line[:reach], line[reach + width :] = screen_length[row, 0], screen_length[row, width - 1]
            out, weight = screen_length_next[row], real(1)
            out[:] = screen_length[row]
            for k in range(1, reach + 1):
                w = decay(real(k * k) * spread)
                weight += w + w
                if along == 1:
                    one, two = screen_length[max(row - k, 0)], screen_length[min(row + k, height - 1)]
                else:
                    one, two = line[reach - k : reach - k + width], line[reach + k : reach + k + width]
                for column in range(width):
                    out[column] += w * (one[column] + two[column])
            for column in range(width):
                out[column] /= weight
