"""Small versions of the study of the terrain velocity control force (`experiments.flood_control`)."""

import numpy as np
import pytest

from experiments import _flood_control as control
from experiments import flood_control


@pytest.mark.parametrize("name", ["ritter", "stoker", "smooth bump", "Thacker 2-D"])
def test_vc1_vc2_where_nothing_is_steep_nothing_changes(name):
    found = control.identical(control.gentle(quick=True)[name])
    assert found["same"] and found["brake"] == 0.0
    assert found["slope"] < 0.3


def test_vc3_at_rest_there_is_no_brake():
    assert control.water(control.bead(1.0, control.ALWAYS, steps=1), "brake")[0] == 0
    assert control.water(control.bead(1.0, control.ALWAYS, steps=2), "brake")[0] > 1


@pytest.mark.parametrize("slope, free, controlled", [(1.0, 9.81, 4.905), (3.0, 29.43, 2.943)])
def test_vc4_a_bead_slides_as_a_body_on_the_slope_would(slope, free, controlled):
    assert control.bead_acceleration(slope, None) == pytest.approx(free, rel=1e-9)
    assert control.bead_acceleration(slope, control.ALWAYS) == pytest.approx(controlled, rel=0.01)


def test_vc5_the_brake_does_not_depend_on_the_time_step():
    coarse, fine = control.brake_after(0.02), control.brake_after(0.01)
    assert coarse > 1 and fine == pytest.approx(coarse, rel=0.01)


@pytest.mark.parametrize("mode", ["descent", "paper"])
def test_vc6_no_column_is_made_faster(mode):
    scene = control.load_scene("rough_terrain", ["time.end=1", "fluid.spacing=4", f"control.mode={mode}"], "small")
    assert control.gains(scene) <= 0
    bead = control.load_scene("rough_terrain", ["time.end=1", "fluid.spacing=4", "control.mode=bead"], "small")
    assert control.gains(bead) > 0  # uphill: the test can fail


@pytest.fixture(scope="module")
def cliffs():
    return {name: control.over_cliff(given, cell=0.5, r0=0.5, end=5.5) for name, given in control.VARIANTS.items()}


def test_vc7_the_discharge_over_a_cliff_is_ritters_and_own_points_keep_it(cliffs):
    free = cliffs["off"]["discharge"]
    assert free == pytest.approx(8 / 27 * np.sqrt(9.81), rel=0.08)
    assert cliffs["own point"]["discharge"] == pytest.approx(free, rel=0.02)


def test_vc7_is_missed_by_corners_that_reach_over_the_edge(cliffs):
    """Published, not mended: water on the flat before the cliff is braked; the paper's stencil by far the most."""
    free = cliffs["off"]["discharge"]
    cut = {name: 1 - found["discharge"] / free for name, found in cliffs.items()}
    assert cut["4 points, l = h (paper)"] > 0.3
    assert 0.02 < cut["4 points, l <= 2 r0"] < cut["4 points, l = h (paper)"]
    # at this spacing of half a metre the default misses, too; the experiment has it at a quarter
    assert cut["own point"] < cut["4 points, l = 0.25 h (default)"] < cut["4 points, l <= 2 r0"]


def test_at_a_cliff_the_force_bounds_speed_and_energy(cliffs):
    off, on = cliffs["off"], cliffs["4 points, l <= 2 r0"]
    assert on["speed"] < np.sqrt(2 * 9.81 * 11) < off["speed"]
    assert on["energy"] < 0.6 * off["energy"]


def test_figure_9_no_column_is_ever_inside_an_obstacle():
    found = control.inside_obstacles(quick=False)
    assert found["inside"] == 0 and found["looks"] > 1e5 and found["lost"] == 0
    assert found["before"] > 0.3  # the flood did meet the cuboid


def test_the_study_runs_and_claims_nothing_when_quick(tmp_path):
    flood_control.run(tmp_path / "c.h5", quick=True, say=lambda text: None)
    rows = flood_control.report(tmp_path / "c.h5")
    assert len(rows) > 30 and all(row.ok is None and row.bound == "" for row in rows)
    assert not any("nan" in row.measured for row in rows if row.name.startswith(("VC1", "VC2", "VC3", "VC4", "VC5", "VC6", "Figure 9")))
