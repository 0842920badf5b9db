"""Philox4x32-10: the known answers of its authors, in Python integers and compiled (boiling V2)."""

import numpy as np
import pytest

from melt.physics import philox as compiled
from melt.reference import _philox as plain

FULL = 2**32 - 1
KNOWN = [
    ((0, 0, 0, 0), (0, 0), (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
    ((FULL,) * 4, (FULL,) * 2, (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD)),
    (
        (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
        (0xA4093822, 0x299F31D0),
        (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1),
    ),
]


@pytest.mark.parametrize("counter, key, words", KNOWN)
def test_known_answers(counter, key, words):
    assert plain.philox(counter, key) == words
    assert tuple(int(w) for w in compiled.philox(*(np.uint64(c) for c in counter + key))) == words


def test_direction_of_a_pair_is_a_unit_vector_that_turns_with_the_order():
    for first, second in ((0, 1), (7, 3), (123456, 123457)):
        here, there = (np.array(compiled.pair_direction(np.int32(a), np.int32(b), 1.0)) for a, b in ((first, second), (second, first)))
        assert (here == -there).all() and np.linalg.norm(here) == pytest.approx(1, rel=1e-15)
        assert here == pytest.approx(plain.pair_direction(first, second), rel=1e-14)
