"""Measures of threads, by hand."""

import numpy as np
import pytest

from experiments._slime_measures import Landing, folds
from experiments.slime_coil import swing

T = np.linspace(0, 2, 401)


def test_folds_of_a_wave_are_two_in_a_period():
    count, rate = folds(T, 5e-3 * np.sin(2 * np.pi * 3 * T), 6e-3)
    assert count == 12 - 1 and rate == pytest.approx(3, rel=0.02)  # the last extreme is not come back from by 6 mm


def test_what_goes_one_way_does_not_fold():
    assert folds(T, T, 0.01)[0] == folds(T, -T, 0.01)[0] == folds(T, 0 * T, 0.01)[0] == folds([], [], 0.01)[0] == 0


def test_small_swings_do_not_count():
    assert folds(T, 2.9e-3 * np.sin(20 * T), 6e-3)[0] == 0


@pytest.mark.parametrize(("ratio", "one_way"), [(1.0, 1.0), (0.0, 0.0)])
def test_a_coil_goes_one_way_and_a_fold_both(ratio, one_way):
    foot = np.column_stack([np.cos(2 * np.pi * 4 * T), ratio * np.sin(2 * np.pi * 4 * T)])
    rate, found = swing(T, foot + 0.3 * T[:, None])
    assert rate == pytest.approx(4, rel=0.02) and found == pytest.approx(one_way, abs=0.05)


def test_a_layer_lands_when_it_is_slow_and_low():
    landing = Landing(per_layer=2, speed=0.3, outlet=1.0)
    number, x = np.array([0, 1, 2, 3]), np.array([[0.1, 0.2], [0.3, 0.2], [0.0, 0.5], [0.2, 0.5]])
    landing.look(1.0, number, x, np.array([[0, -0.05], [0, -0.05], [0, -0.4], [0, -0.4]]))
    times, lateral = landing.line()
    assert (times, lateral) == (pytest.approx([1.0]), pytest.approx([0.2])) and landing.contact() == pytest.approx(0.4)
