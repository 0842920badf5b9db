"""Philox4x32-10 in Python integers (Salmon et al. 2011)."""

import math


def philox(counter, key):
    """Return four random words of 32 bits from a counter of four and a key of two."""
    c0, c1, c2, c3 = counter
    k0, k1 = key
    for _ in range(10):
        p0, p1 = 0xD2511F53 * c0, 0xCD9E8D57 * c2
        c0, c1, c2, c3 = (p1 >> 32) ^ c1 ^ k0, p1 % 2**32, (p0 >> 32) ^ c3 ^ k1, p0 % 2**32
        k0, k1 = (k0 + 0x9E3779B9) % 2**32, (k1 + 0xBB67AE85) % 2**32
    return c0, c1, c2, c3


def pair_direction(first, second):
    """Return the unit vector that two particles at one place share; it points from the larger id to the smaller."""
    words = philox((min(first, second), max(first, second), 0, 0), (0, 2))
    v = [(w >> 11) - 2**20 + 0.5 for w in words[:3]]
    turn = (1 if first < second else -1) / math.sqrt(sum(c * c for c in v))
    return [turn * c for c in v]


def random_words(id, step_low, step_high, number, seed_low, seed_high, stream):
    """Return the four words of draw ``number`` of a particle in a step; int32 bit patterns are taken as unsigned."""
    counter = int(id) % 2**32, 0, int(step_low) % 2**32, number
    return philox(counter, (int(seed_low) % 2**32, (int(seed_high) ^ int(step_high) ^ stream) % 2**32))


def ball_offset(id, step_low, step_high, seed_low, seed_high, stream):
    """Return a point of the unit ball: signed integers of 21 bits, up to 16 draws, the last one halved."""
    for number in range(16):
        words = random_words(id, step_low, step_high, number, seed_low, seed_high, stream)[:3]
        v = [(w if w < 2**31 else w - 2**32) >> 11 for w in words]  # arithmetic shift
        if sum(c * c for c in v) <= 2**40:
            return [c / 2**20 for c in v]
    return [c / 2**21 for c in v]
