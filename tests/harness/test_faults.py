"""A harness must be shown to fail: every planted fault turns it red."""

import numpy as np
import pytest

from melt.check.compare import SENTINEL, InputChanged, compare_outputs, difference, run_stage, stage_function
from melt.check.faults import FAULTS, swappable
from melt.check.inputs import make
from melt.stages import STAGES

#: Stages whose first two equal inputs may change places: b + d, products of the two, and arrays of cells that no reference looks at.
SYMMETRIC = {"flood_surface", "flood_land", "flood_neighbours", "wall_neighbours"}
SYMMETRIC |= {"pressure_start", "pressure_acceleration", "poisson_acceleration", "total_pressure"}


def applies(fault, stage, arrays):
    """Return whether the stage has what the fault needs."""
    entry = STAGES[stage]
    if fault == "swapped_arguments":
        if stage in SYMMETRIC:
            return False
        return swappable(stage, [arrays.get(a) for a in entry.arguments]) is not None
    if fault == "wrong_field":
        return any(arrays[a].dtype.kind == "f" for a in entry.reads if a not in entry.writes)
    return True


def ratio_with(fault, stage, backend, precision="double"):
    """Return the worst ratio of a stage with a fault planted in ``backend``; infinity if it fails."""
    arrays, params, scales = make(stage, precision, 301)
    right = run_stage(stage, "reference", arrays, params)
    broken = FAULTS[fault](stage, stage_function(stage, backend))
    try:
        wrong = run_stage(stage, backend, arrays, params, function=broken)
    except Exception:  # a stage that fails is red in the report, too
        return np.inf
    return max(d.ratio for d in compare_outputs(stage, right, wrong, precision, scales).values())


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("stage", STAGES)
def test_planted_fault_turns_the_check_red(stage, fault):
    arrays, _, _ = make(stage, "double", 301)
    if not applies(fault, stage, arrays):
        pytest.skip(f"{stage} has no arguments for {fault}")
    assert ratio_with(fault, stage, "reference") > 1


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_fault_in_the_cpu_twin_turns_the_check_red_in_single_precision(fault):
    assert ratio_with(fault, "density", "cpu", "single") > 1


def test_stage_that_writes_an_input_is_refused():
    def greedy(*arguments):
        stage_function("density", "reference")(*arguments)
        arguments[2][0] += 1  # mass

    arrays, params, _ = make("density", "double", 301)
    with pytest.raises(InputChanged, match="mass"):
        run_stage("density", "reference", arrays, params, function=greedy)


def test_poison_left_by_both_sides_is_red():
    arrays, params, scales = make("density", "double", 301)
    left = run_stage("density", "reference", arrays, params, function=lambda *a: None)
    assert compare_outputs("density", left, left, "double", scales)["density"].ratio == np.inf


def test_sentinel_left_in_integers_is_red():
    arrays, params, scales = make("cell_index", "double", 301)
    left = run_stage("cell_index", "reference", arrays, params, function=lambda *a: None)
    assert (left["cell"] == SENTINEL).all()
    assert compare_outputs("cell_index", left, left, "double", scales)["cell"].ratio == np.inf


def test_tolerance_is_a_threshold_and_not_a_decoration():
    rtol, atol = STAGES["density"].tolerance.of("double")
    allowed = (rtol + atol) * 1000.0
    reference = np.full(3, 1000.0)
    for factor, passes in ((0.9, True), (1.1, False)):
        got = reference + np.array([0.0, factor * allowed, 0.0])
        found = difference("density", "density", reference, got, "double", {"density": 1000.0})
        assert (found.ratio <= 1) == passes and found.index == (1,)


def test_nan_on_one_side_and_differing_integers_are_infinitely_wrong():
    x = np.ones(3)
    y = np.array([1.0, np.nan, 1.0])
    assert difference("density", "density", x, y, "single", {}).ratio == np.inf
    i = np.array([1, 2, 3], np.int32)
    assert difference("cell_index", "cell", i, i + np.int32([0, 0, 1]), "single", {}).ratio == np.inf
