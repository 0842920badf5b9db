"""Philox4x32-10: random words without a state, the same on every backend. Boiling spec 3.

Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3". A counter of four words and a key of
two give four random words; a draw is named by what it is for (particle, step, number), so results do not
depend on the order in which threads ask.
"""

import math

import numpy as np

from melt._compile import scalar


@scalar
def philox(c0, c1, c2, c3, k0, k1):
    """Return four random words; all arguments and results are uint64 below 2^32."""
    low = np.uint64(0xFFFFFFFF)
    half = np.uint64(32)
    for _ in range(10):
        p0 = np.uint64(0xD2511F53) * c0
        p1 = np.uint64(0xCD9E8D57) * c2
        c0, c1, c2, c3 = (p1 >> half) ^ c1 ^ k0, p1 & low, (p0 >> half) ^ c3 ^ k1, p0 & low
        k0 = (k0 + np.uint64(0x9E3779B9)) & low
        k1 = (k1 + np.uint64(0xBB67AE85)) & low
    return c0, c1, c2, c3


@scalar
def pair_direction(first, second, like):
    """Return a unit vector (x, y, z) of the type of ``like`` that two ids share; it turns with their order.

    Words are cut to 21 bits with sign: every backend gets the same integers.
    """
    real = type(like)
    low, high = np.uint64(min(first, second)), np.uint64(max(first, second))
    zero = np.uint64(0)
    a, b, c, _ = philox(low, high, zero, zero, np.uint64(0), np.uint64(2))
    shift, middle = np.uint64(11), real(1 << 20)
    # half a unit off: never the null vector
    x = real(np.int64(a >> shift)) - middle + real(0.5)
    y = real(np.int64(b >> shift)) - middle + real(0.5)
    z = real(np.int64(c >> shift)) - middle + real(0.5)
    turn = (real(1) if first < second else real(-1)) / math.sqrt(x * x + y * y + z * z)
    return turn * x, turn * y, turn * z


@scalar
def random_words(id, step_low, step_high, number, seed_low, seed_high, stream):
    """Return the four words of draw ``number`` that a particle makes in a step.

    Streams: 0 birth of bubbles, 1 nucleation, 2 ties and condensate, 3 vapour. All arguments are integers; those of 32 bits
    (seed, step) arrive as the bit patterns of int32.
    """
    low, zero = np.uint64(0xFFFFFFFF), np.uint64(0)
    key = np.uint64(seed_high) ^ np.uint64(step_high) ^ np.uint64(stream)
    return philox(
        np.uint64(id) & low, zero, np.uint64(step_low) & low, np.uint64(number) & low, np.uint64(seed_low) & low, key & low
    )


@scalar
def unit_share(c0, like):
    """Return a word as a number from 0 to below 1 of the type of ``like``: 24 bits, exact in single precision."""
    real = type(like)
    return real(np.int64(c0 >> np.uint64(8))) / real(1 << 24)


@scalar
def ball_offset(id, step_low, step_high, seed_low, seed_high, stream, like):
    """Return a point (x, y, z) in the unit ball, uniform, of the type of ``like``.

    Three integers of 21 bits with sign, drawn again (16 times at most) until they lie in the ball; the last draw
    is halved. Multiples of 2^-21: exact in single precision, and the same on every backend.
    """
    real = type(like)
    sign, shift = np.int64(1 << 20), np.uint64(11)
    unit = real(1) / real(1 << 20)
    i = j = k = np.int64(0)
    for number in range(16):
        a, b, c, _ = random_words(id, step_low, step_high, number, seed_low, seed_high, stream)
        i = (np.int64(a >> shift) ^ sign) - sign
        j = (np.int64(b >> shift) ^ sign) - sign
        k = (np.int64(c >> shift) ^ sign) - sign
        if i * i + j * j + k * k <= np.int64(1 << 40):
            return unit * real(i), unit * real(j), unit * real(k)
    unit *= real(0.5)
    return unit * real(i), unit * real(j), unit * real(k)
