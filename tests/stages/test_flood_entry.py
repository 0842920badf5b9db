"""Columns that enter: how far the nearest water is, and what a column that comes into being is like."""

import numpy as np
import pytest
from flood_motion_cases import AIRBORNE, FLOOD, INACTIVE, LIQUID, arrays, run
from liquid_cases import BACKENDS, REALS, everywhere

#: Columns in cell order (cells of 1 m, 6 x 5): row 0, row 1, one that is beyond the grid, a free slot.
PLACES = [[0.5, 0.5, 0], [3.25, 0.5, 0], [3.5, 0.5, 0], [0.5, 1.5, 0], [40.0, 4.5, 0], [3.0, 0.5, 0]]
PHASES = [LIQUID, AIRBORNE, LIQUID, LIQUID, LIQUID, INACTIVE]


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_clearance_is_the_distance_to_the_nearest_water(backend, precision):
    """Neither a falling column nor a free slot counts, nor does height; farther than 2.5 m is as good as nothing."""
    entries = [[0.5, 1.25, 99], [3.25, 0.5, 0], [3.5, 2.5, 0], [0.5, 4.5, 0], [37.5, 4.5, 0], [38, 4.5, 0], [-1, -1.5, 0], [0.5, 0.5, 0]]
    a = arrays(PLACES, PHASES, precision, search=True, entry_position=np.transpose(entries))
    found = run("entry_clearance", backend, a)["entry_clearance"]
    want = [0.25, 0.25, 2.0, 2.5, 2.5, 2.0, 2.5, 0.0]
    assert found == pytest.approx(want, rel=1e-6 if precision != "double" else 1e-14)


@everywhere
def test_clearance_agrees_with_all_pairs(backend):
    rng = np.random.default_rng(5)
    x = np.column_stack([rng.uniform(-2, 8, 40), rng.uniform(-2, 7, 40), np.zeros(40)])
    cell = np.clip(np.floor(x[:, 1]), 0, 4) * 6 + np.clip(np.floor(x[:, 0]), 0, 5)
    entries = np.array([rng.uniform(-4, 10, 50), rng.uniform(-4, 9, 50), np.zeros(50)])
    a = arrays(x[np.argsort(cell, kind="stable")], search=True, entry_position=entries)
    found = run("entry_clearance", backend, a)["entry_clearance"]
    apart = np.hypot(entries[0][:, None] - x[:, 0], entries[1][:, None] - x[:, 1]).min(axis=1)
    assert found == pytest.approx(np.minimum(apart, 2.5), rel=1e-14)


@everywhere
def test_dry_ground_has_all_the_room_there_is(backend):
    a = arrays([[1, 1, 0]], AIRBORNE, search=True, entry_position=[[1.0, np.nan], [1.0, 1.0], [0.0, 0.0]])
    assert (run("entry_clearance", backend, a)["entry_clearance"] == 2.5).all()


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_entering_fills_the_slots_and_no_others(backend, precision):
    """Two of three entries into slots 2 and 3: support 2 sqrt(V/d_ref), clamped, and the depth that goes with it."""
    phase = [LIQUID, LIQUID, INACTIVE, INACTIVE, INACTIVE]
    a = arrays(
        np.full((5, 3), -1.0), phase, precision, entry_position=[[1, 2, 3], [4, 5, 6], [7, 8, 9]],
        entry_velocity=[[0.5, 0, 0], [0, -0.5, 0], [0, 0, 0]], entry_volume=[0.25, 4.0, 1.0],
    )
    before = {k: v.copy() for k, v in a.items()}
    run("enter", backend, a, count=2, slot=2, density=1000.0, first_id=70)
    assert a["phase"].tolist() == [LIQUID] * 4 + [INACTIVE] and a["id"].tolist() == [0, 1, 70, 71, 4]
    assert (a["position"][:, 2:4].T == [[1, 4, 7], [2, 5, 8]]).all() and (a["position_before"][:, 2:4] == a["position"][:, 2:4]).all()
    assert (a["velocity"][:, 2:4].T == [[0.5, 0, 0], [0, -0.5, 0]]).all()
    assert a["mass"][2:4].tolist() == [250, 4000] and a["rest_volume"][2:4].tolist() == [0.25, 4]
    # the second would need h = 4 m, more than the largest, 2.5 m: its depth is 4 (2/2.5)^2
    assert a["support_radius"][2:4].tolist() == [1.0, FLOOD["largest"]]
    assert a["depth"][2:4] == pytest.approx([1.0, 2.56], rel=1e-6) and a["brake"][2:4].tolist() == [0, 0]
    for name in ("phase", "id", "position", "velocity", "mass", "rest_volume", "support_radius", "position_before", "depth", "brake"):
        assert (a[name][..., [0, 1, 4]] == before[name][..., [0, 1, 4]]).all(), name


@pytest.mark.parametrize("backend", BACKENDS)
def test_nothing_is_fine(backend):
    none = dict(entry_position=np.zeros((3, 0)), entry_velocity=np.zeros((3, 0)))
    a = arrays(np.zeros((0, 3)), search=True, **none)
    run("entry_clearance", backend, a)
    run("enter", backend, a, count=0, slot=0, density=1000.0, first_id=0)
    a = arrays(np.zeros((0, 3)), search=True, entry_position=np.zeros((3, 2)))
    assert (run("entry_clearance", backend, a)["entry_clearance"] == 2.5).all()
