"""The heat page: choice of solver, conjugate gradients, fallback, extremes, repeatability."""

from types import SimpleNamespace

import numpy as np
import pytest
from extreme_scenes import scene

from experiments._heat_slab import Slab
from melt import _compile
from melt.simulation import Simulation
from melt.systems.heat import SOLVERS, chosen_solver, fourier_number, thermal_substeps


@pytest.fixture(autouse=True)
def keep_emulation():
    """Backends choose where CUDA kernels run; put it back."""
    before = _compile.Kernel.emulated
    yield
    _compile.Kernel.emulated = before


def slab(solver="cg", shape=(12, 4, 3), T0=lambda x: np.where(x[0] < 1.2, -10.0, 40.0), **options):
    return Slab(shape, solver=solver, T0=T0, jitter=0.2, **options)


def test_auto_chooses_by_fourier_number():
    assert fourier_number(0, 0.005, 0.2, 0.5) == pytest.approx(0.125)
    assert fourier_number(1, 0.2, 1e-3, 0.56, 1000.0, 4187.0) == pytest.approx(0.02675, rel=1e-3)
    settings = SimpleNamespace(heat_solver="auto", fourier_number=0.5, heat_substeps=1, dt=0.01)
    assert chosen_solver(settings) == "pairs_coloured"
    settings.fourier_number = 0.6
    assert chosen_solver(settings) == "cg"
    settings.heat_substeps = "auto"
    assert thermal_substeps(settings) == 2 and chosen_solver(settings) == "pairs_coloured"
    settings.heat_solver = "explicit"
    assert chosen_solver(settings) == "explicit"


def test_auto_follows_the_dt_of_the_step():
    settings = SimpleNamespace(heat_solver="auto", fourier_number=4.0, heat_substeps=1, dt=0.01)
    assert [chosen_solver(settings, dt) for dt in (0.01, 0.00126, 0.00125)] == ["cg", "cg", "pairs_coloured"]
    settings.heat_substeps = "auto"
    assert [thermal_substeps(settings, dt) for dt in (0.02, 0.01, 0.00126, 0.001)] == [16, 8, 2, 1]
    # pairs at the scene's dt: there are no fields for cg, so a longer step takes more sub-steps
    settings.fourier_number, settings.heat_substeps = 0.4, 1
    for dt, number in ((0.001, 1), (0.01, 1), (0.02, 2), (0.1, 8)):
        assert thermal_substeps(settings, dt) == number and chosen_solver(settings, dt) == "pairs_coloured"
    settings.heat_solver = "cg"
    assert thermal_substeps(settings, 0.1) == 1


@pytest.mark.parametrize("conductivity, dt, ran", [(4000.0, 1e-5, "heat_pairs_coloured"), (40.0, 0.5, "heat_pairs_coloured"),
                                                   (4000.0, 0.005, "heat_conductance")])
def test_a_step_by_hand_takes_the_solver_of_its_dt(conductivity, dt, ran):
    sim = Simulation(scene(heat={"conductivity": conductivity}, solver={"motion": False}), "cpu")
    sim.step(dt)
    assert (ran in sim.do.launches) and len({"heat_pairs_coloured", "heat_conductance"} & set(sim.do.launches)) == 1


def test_notes_are_of_all_thermal_sub_steps():
    one, two = slab("cg").step(0.05), slab("cg", substeps=2).step(0.1)
    first = one.do.notes["heat_iterations"], one.do.notes["heat_residual"]
    one.step(0.05)
    second = one.do.notes["heat_iterations"], one.do.notes["heat_residual"]
    assert two.do.notes["heat_iterations"] == first[0] + second[0]
    assert two.do.notes["heat_residual"] == max(first[1], second[1])


@pytest.mark.parametrize("backend", ("reference", "cpu", "cuda-emulated"))
@pytest.mark.parametrize("latent", (False, True))
def test_cg_solves_the_dense_system(backend, latent):
    options = (
        dict(latent=True, latent_heat=(20.0,), melting_point=(0.0,), phase=lambda k: np.ones(k.shape[1], int))
        if latent
        else {}
    )
    a = slab(backend=backend, **options)
    x, T0, V = a.read("position"), a.read("temperature"), 0.008
    E0 = T0 * V + (a.read("latent_energy") if latent else 0)
    if latent:  # start on the curve: hot solid has melted in part
        E0 = np.where(T0 > 0, V * T0 + a.read("latent_energy"), V * T0)
    a.step(0.05)
    r = np.sqrt(((x[:, :, None] - x[:, None, :]) ** 2).sum(axis=0))
    G = 2 * 0.5 * V * V * 45 / (np.pi * 0.5**6) * np.maximum(0.5 - r, 0)
    np.fill_diagonal(G, 0)
    lap = np.diag(G.sum(axis=1)) - G
    T = a.read("temperature")
    if not latent:
        truth = np.linalg.solve(V * np.eye(len(T0)) + 0.05 * lap, V * T0)
        assert T == pytest.approx(truth, abs=1e-6)
    E = V * T + (a.read("latent_energy") if latent else 0)
    assert E - E0 == pytest.approx(-0.05 * lap @ T, abs=1e-7)  # the balance of backward Euler itself
    assert a.do.notes["heat_iterations"] > 3 and a.do.notes["heat_residual"] < 1e-6
    assert "heat_fallback" not in a.do.notes


@pytest.mark.parametrize("precision", ("single", "double"))
@pytest.mark.parametrize("K", (1e6, 1e30))
@pytest.mark.parametrize("solver", ("cg", "pairs_coloured", "pairs_seq", "onesided"))
def test_any_conductivity_is_bounded(solver, K, precision):
    a = slab(solver, conductivity=(K,), precision=precision)
    before = a.energy()
    a.step(1.0)
    T = a.read("temperature")
    room = 1e-8 if precision == "double" else 0.05
    assert np.isfinite(T).all() and T.min() >= -10 - room and T.max() <= 40 + room
    if solver != "onesided":
        size = 0.008 * 40 * T.size
        assert abs(a.energy() - before) <= (1e-12 if precision == "double" else 1e-5) * size


def test_fallback_reports_itself_and_takes_the_whole_step():
    a = slab("cg", tolerance=1e-14)
    a.do.settings.heat_iterations = 1
    a.step(0.5)
    assert a.do.notes["heat_fallback"] == 1 and a.do.notes["heat_iterations"] >= 1
    b = slab("pairs_seq").step(0.5)
    assert (a.read("temperature") == b.read("temperature")).all()


@pytest.mark.parametrize("solver", list(SOLVERS))
@pytest.mark.parametrize("precision", ("single", "double"))
def test_nothing_to_do_is_nothing_done(solver, precision):
    a = slab(solver, conductivity=(0.0,), precision=precision)
    T = a.read("temperature")
    assert (a.step(0.1).read("temperature") == T).all()
    b = slab(solver, precision=precision, T0=lambda x: np.full(x.shape[1], 17.3))
    T = b.read("temperature")
    assert (b.step(0.1).read("temperature") == T).all()


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_twins_agree_on_the_page(solver):
    one = slab(solver, backend="cpu").step(0.01, 3).read("temperature")
    two = slab(solver, backend="cuda-emulated").step(0.01, 3).read("temperature")
    three = slab(solver, backend="reference").step(0.01, 3).read("temperature")
    assert two == pytest.approx(one, abs=1e-9) and three == pytest.approx(one, abs=1e-9)
    assert np.ptp(one) < 50


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_substeps(solver):
    whole = slab(solver, substeps=2).step(0.01).read("temperature")
    halves = slab(solver).step(0.005, 2).read("temperature")
    assert (whole == halves).all()
