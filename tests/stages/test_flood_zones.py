"""Open boundaries: what is measured beside them, and what drives their columns."""

import numpy as np
import pytest
from flood_motion_cases import AIRBORNE, INACTIVE, LIQUID, arrays, run
from liquid_cases import BACKENDS, REALS, everywhere

BOX = np.array([[0.0, 1.0, 0.0, 4.0], [4.0, 6.0, 2.0, 3.0], [9.0, 9.5, 0.0, 1.0]]).T
NORMAL = np.array([[1.0, 0.0], [0.6, -0.8], [1.0, 0.0]]).T


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_sums_by_hand(backend, precision):
    """Boxes are half open; falling columns and free slots are no water; an empty probe has sums of 0."""
    x = [[0.0, 0, 0], [0.5, 3.75, 0], [1.0, 1, 0], [0.5, 4.0, 0], [0.5, 1, 0], [0.5, 1, 0], [5.0, 2.5, 0]]
    phase = [LIQUID] * 4 + [AIRBORNE, INACTIVE, LIQUID]
    v = np.array([[1, 9, 0], [-2, 9, 0], [50, 0, 0], [50, 0, 0], [50, 0, 0], [50, 0, 0], [5, 2.5, 0]]).T
    a = arrays(
        x, phase, precision, velocity=v, rest_volume=[1, 2, 4, 8, 16, 32, 3], depth=[0.5, 1, 1, 1, 1, 1, 1.5],
        zone_probe=BOX, zone_normal=NORMAL,
    )
    sums = run("zone_sums", backend, a)["zone_sums"]
    assert sums.dtype == np.float64
    # areas 2 + 2; 1 x 1 - 2 x 2; second zone: v . n = 3 - 2
    assert sums.T == pytest.approx(np.array([[4, -3, 3], [2, 3, 3], [0, 0, 0]]), rel=1e-12 if precision == "double" else 1e-6)


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_drive_sets_the_normal_velocity_and_no_other(backend, precision):
    x = [[0.5, 1, 0], [5.0, 2.5, 0], [2.0, 1, 0], [0.5, 1, 0], [9.25, 0.5, 0]]
    v = np.tile([[7.0], [8.0], [0.5]], 5)
    a = arrays(
        x, [LIQUID, LIQUID, LIQUID, AIRBORNE, LIQUID], precision, velocity=v,
        zone_box=BOX, zone_normal=NORMAL, zone_speed=[1.5, -2.0, np.nan],
    )
    run("zone_drive", backend, a)
    want = np.array([[1.5, 0, 0.5], [-1.2, 1.6, 0.5], [7, 8, 0.5], [7, 8, 0.5], [7, 8, 0.5]])
    assert a["velocity"].T == pytest.approx(want, rel=1e-6)


@everywhere
def test_the_first_zone_that_drives_has_a_column_in_several(backend):
    box = np.array([[0.0, 2, 0, 2]] * 3).T
    a = arrays([[1, 1, 0]], zone_box=box, zone_normal=np.array([[1, 0], [0, 1], [0, -1.0]]).T, zone_speed=[np.nan, 2.0, 3.0])
    run("zone_drive", backend, a)
    assert a["velocity"][:, 0].tolist() == [0, 2, 0]


@pytest.mark.parametrize("backend", BACKENDS)
def test_nothing_is_fine(backend):
    zones = dict(zone_probe=BOX, zone_box=BOX, zone_normal=NORMAL, zone_speed=np.ones(3))
    a = arrays(np.zeros((0, 3)), **zones)
    assert (run("zone_sums", backend, a)["zone_sums"] == 0).all()
    run("zone_drive", backend, a)
    none = dict(zone_probe=np.zeros((4, 0)), zone_box=np.zeros((4, 0)), zone_normal=np.zeros((2, 0)), zone_speed=np.zeros(0))
    a = arrays([[1, 1, 0]], velocity=np.ones((3, 1)), **none)
    run("zone_sums", backend, a)
    run("zone_drive", backend, a)
    assert (a["velocity"] == 1).all()
