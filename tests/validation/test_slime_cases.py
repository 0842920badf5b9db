"""Small versions of `experiments.slime_analytic`, with the bounds of the slime spec, section 5, for their resolution, and of
`slime_square`."""

import h5py
import numpy as np
import pytest
from scipy.spatial import cKDTree

from experiments import _slime_patch as patch
from experiments import _slime_plates as plates
from experiments import _slime_rest as rest
from experiments import slime_analytic, slime_square
from experiments._slime_runs import liquid, start
from experiments._slime_spread import sheared


@pytest.mark.parametrize("kind", ["couette", "poiseuille"])
def test_start_up_between_plates(kind):
    """20 across: 5 %, at every instant. Without mirrored walls, water slips: 20 % of Poiseuille's speeds."""
    assert plates.start_up(kind, 20)["worst"] <= 0.05  # 3.6 % (at first), and 4.9997 %: rows have 0.956 of their viscosity


def test_walls_must_mirror():
    assert plates.start_up("poiseuille", 20, "viscosity.wall=0.5")["L2"] > 0.15


def test_wider_support_mends_shear():
    found = plates.start_up("poiseuille", 20, *(s.replace("0.009", "0.012") for s in slime_analytic.WIDE))
    assert found["L2"] <= 0.02


def test_pair_forces_have_the_viscosity_in_the_mean_over_directions():
    """Not in any one: that is what lattices lack, and no factor on the strength would mend it."""
    found = plates.operator(end=0.0)
    assert found["mean"] == pytest.approx(1, abs=0.01) and found["shear"] < 0.96 < 1.05 < found["extension"]


def test_ghosts_stand_in_air():
    sim = start("hydrostatic")
    sim.step()
    ghosts = sim.do.read("ghost_position")[:, : int(sim.do.read("ghost_start")[-2])][[0, 2]].T
    gap, _ = cKDTree(sim.read("position")[:, [0, 2]]).query(ghosts)
    assert len(ghosts) > 40 and gap.min() > 0.78 * sim.scene.spacing  # 0.8 before the liquid moved


def test_a_tank_at_rest():
    found = rest.tank(end=0.2)
    assert found["L2_each"] <= 0.01 and found["surface_std"] <= 0.3 and "density 2" in found["settings"]
    assert found["largest"] <= 0.01  # it grows: 0.06 sqrt(g H) after 1 s, 0.0013 with APIC particles


def test_a_film_on_an_incline():
    found = plates.film(20, 0.1, "solver.pressure=hybrid", "solver.ghosts={}")
    assert found["ratio"] == pytest.approx(1, abs=0.04)


def test_a_rotating_square_is_held_by_negative_pressure():
    found, broken = patch.square(end=0.5), patch.square("solver.pressure=dfsph", end=2.0, ghosts=False)
    # of the corner the spec's 1 is missed by less than 0.1 %: the published table says so
    assert found["centre"] == pytest.approx(-patch.CENTRE, rel=0.01)
    assert abs(found["spin"]) <= 0.01 and found["corner"] <= 1.001 and found["loneliest"] < 1.3
    assert broken["least"] >= 0 and broken["loneliest"] > 2


@pytest.mark.parametrize(("settings", "taken"), [(["solver.dfsph.pull=0"], {}), ([], {"nodes": True})])
def test_an_ellipse_stretches(settings, taken):
    """Energy with APIC particles is lost in every transfer: 1.8 % with the default pull, a miss in the published table."""
    found = patch.ellipse(*settings, **taken)
    assert max(abs(found["x"]), abs(found["z"])) <= 0.01 and abs(found["energy"]) <= 0.015


def test_an_ellipse_whose_rows_are_stretched_decouples():
    """Why lattices are turned: the shorter axis is then far off."""
    sim = start("oscillating_drop", "fluid.central=0", "fluid.flow.rate=1.0", "domain.spacing=0.0795")
    q = liquid(sim)
    first = patch.axes(q.x, q.m)
    while sim.time < 1 - 1e-9:
        sim.step()
    b = patch.axes_of(1.0, 1.0)[2][-1]
    q = liquid(sim)
    assert (patch.axes(q.x, q.m) / first)[1] / b > 1.1


def test_exact_ellipses_keep_area_and_energy():
    t, a, b = patch.axes_of(1.0, 1.0)
    assert np.allclose(a * b, 1, atol=1e-9)
    rate = np.gradient(a, t, edge_order=2) / a
    assert np.allclose(rate**2 * (a**2 + b**2), 2, rtol=1e-5)
    t, a, b = patch.axes_of(1e-3, 12.0, 1.0)
    assert patch._upward(t, a)[1] == pytest.approx(2 * np.pi / np.sqrt(2), rel=1e-4)


@pytest.mark.parametrize("experiment", [slime_analytic, slime_square])
def test_quick_run_and_report(experiment, tmp_path):
    experiment.run(tmp_path / "quick.h5", quick=True, say=lambda text: None)
    rows = experiment.report(tmp_path / "quick.h5")
    with h5py.File(tmp_path / "quick.h5") as file:
        assert not any("failed" in file[name].attrs for name in file)
    assert rows and all(row.ok is None and not row.bound for row in rows)


def test_drag_on_a_square_that_starts_to_move():
    """10 across, until it moves steadily. Added mass is large by the corners, whose particles see more of the liquid."""
    found, wanted = slime_square.square((), 1.375), slime_square.reference()
    drag = slime_square.windows(found["time"], found["drag"], wanted)
    at = {round(t, 2): (*row, p, v) for t, row, p, v in zip(wanted["time"], drag, wanted["pressure"], wanted["viscous"])}
    pressure, shear, p, v = at[0.55]
    assert 1.0 < pressure / p < 1.25 and shear == pytest.approx(v, rel=0.15)
    pressure, shear, p, v = at[1.25]
    assert pressure + shear == pytest.approx(p + v, rel=0.1)
    assert 0.9 < found["least"] and found["most"] < 1.1


def test_an_elastic_liquid_is_sheared():
    """Stress and normal stress difference grow as those of Oldroyd-B; the liquid itself needs a tenth of this to start."""
    found = sheared(0.3)
    assert [found[name] for name in ("tau", "N1", "rate")] == pytest.approx([1, 1, 1], abs=0.03)  # 0.993, 0.984, 0.999
