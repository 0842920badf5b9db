"""Position based fluid: kernels, density constraint, solve, masks of the effect precision (boiling V1, V3, V5, V8)."""

import numpy as np
import pytest
from liquid_cases import BACKENDS, REALS, both, everywhere
from pbf_cases import MASS, D, arrays, d0, lattice, pbf_tuple, run, vessel_tuple

from melt.position_based import kernel_table, lattice_sums, squared_gradients, stiffness

TABLE = [  # R/d, S, G, N_L, c2, Lmax, D_lat of the spec
    (1.6, 0.94984, 0.78142, 1.14674, 1.12, 1.99, 0.57724),
    (1.8, 0.98284, 0.90261, 1.10126, 1.85, 2.37, 0.48305),
    (2.0, 1.00978, 0.95629, 0.98812, 2.57, 2.67, 0.37339),
    (2.2, 1.01401, 0.95311, 0.88624, 3.17, 2.98, 0.27787),
    (2.5, 0.99543, 0.94983, 1.02122, 5.00, 3.58, 0.17324),
    (3.0, 1.00219, 0.98956, 0.95593, 12.1, 5.94, 0.08067),
]


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"R={row[0]}")
def test_lattice_sums_and_spectrum_are_those_of_the_spec(row):
    ratio, S, G, N_L, c2, most, D_lat = row
    assert lattice_sums(ratio) == pytest.approx((S, G, N_L), abs=5.1e-6)
    assert squared_gradients(ratio) == pytest.approx(D_lat, abs=5.1e-6)
    assert stiffness(ratio).slow == pytest.approx(c2, rel=0.012)
    assert stiffness(ratio).largest == pytest.approx(most, abs=0.006)


def test_kernels_integrate_to_one():
    r = (np.arange(200000) + 0.5) / 200000
    shell = 4 * np.pi * r**2 / 200000
    assert (shell * 315 / (64 * np.pi) * (1 - r**2) ** 3).sum() == pytest.approx(1, abs=1e-10)
    assert (shell * 45 / np.pi * (1 - r) ** 2 * r / 3).sum() == pytest.approx(1, abs=1e-10)
    assert (shell * 45 / np.pi * (1 - r) * r**2 / 6).sum() == pytest.approx(1, abs=1e-10)


def test_table_is_exact_at_its_end_and_close_between():
    table = kernel_table(2.2)
    S, G, _ = lattice_sums(2.2)
    assert table[:, -1] == pytest.approx([315 / (64 * np.pi * S), 45 / (np.pi * G)], rel=1e-14)
    at = 2.0123
    t = (at - 1.5) / (2.2 - 1.5) * (table.shape[1] - 1)
    k = int(t)
    between = table[:, k] + (t - k) * (table[:, k + 1] - table[:, k])
    S, G, _ = lattice_sums(at)
    assert between == pytest.approx([315 / (64 * np.pi * S), 45 / (np.pi * G)], rel=5e-6)


def walled(n=4, layers=3):
    """A cube of n^3 liquid particles with walls on all sides."""
    x = lattice(n + 2 * layers) - layers * D
    inside = ((x > 0) & (x < n * D)).all(axis=1)
    return x, np.where(inside, 0, 2)


@everywhere
@pytest.mark.parametrize("ratio", [1.6, 2.2, 2.5])
@both
def test_lattice_in_walls_is_at_rest(backend, ratio, precision):
    """V3: beside walls of particles too, C = 0 and nothing is pushed."""
    x, phase = walled()
    a = arrays(x, phase, precision, ratio)
    pbf = pbf_tuple(ratio, a["mass"].dtype.type)
    liquid = phase == 0
    C = run("pbf_lambda", backend, a, pbf)["constraint"][liquid]
    run("pbf_correction", backend, a, pbf, iteration=0)
    assert np.abs(C).max() <= (1e-12 if precision == "double" else 1e-6)
    assert np.abs(a["correction"][:, liquid]).max() <= (1e-12 if precision == "double" else 3e-6) * D


@everywhere
def test_linear_precision_on_the_lattice_has_no_error(backend):
    """V3: R from 0.73 to 1 of the largest along z changes C by at most 2e-4 inside; plain kernels err by 4.6 %."""
    x = lattice(7, 7, 20)
    F = 0.73 + 0.27 * x[:, 2] / (20 * D)
    a = arrays(x, ratio=2.5, support_radius=np.maximum(2.5 * D * F, 1.6 * D))
    run("pbf_lambda", backend, a, pbf_tuple(2.5, uniform=0))
    inside = ((x > 2.6 * D) & (x < x.max(axis=0) - 2.1 * D)).all(axis=1)
    assert inside.sum() > 10
    assert np.abs(a["constraint"][inside]).max() <= 2e-4


@everywhere
@both
def test_pair_by_hand(backend, precision):
    """Eqs (4) to (6) of two particles of unequal mass and volume at 0.5 R."""
    R, V, m = 2.2 * D, np.array([1.0, 0.7]) * D**3, np.array([1.0, 2.0]) * MASS
    a = arrays([[0, 0, 0], [0.5 * R, 0, 0]], 0, precision, volume=V, mass=m, mobility=1 / m)
    pbf = pbf_tuple(real=a["mass"].dtype.type, softening=d0(2.2), push=0.1 / d0(2.2), omega=0.8)
    S, G, _ = lattice_sums(2.2)
    W0, W = (315 / (64 * np.pi * R**3 * S) * c for c in (1.0, 0.75**3))
    g = 45 / (np.pi * R**4 * G) * 0.25
    C = V * W0 + V[::-1] * W - 1
    D_i = (V[::-1] * g) ** 2 * (1 / m).sum() + d0(2.2)
    lam = -C / D_i
    s = -0.1 / d0(2.2) * (0.75 / 0.96) ** 12
    push = lam[0] * V[1] + lam[1] * V[0] + s * V.sum() / 2
    run("pbf_lambda", backend, a, pbf)
    run("pbf_correction", backend, a, pbf, iteration=0)
    rel = 3e-6 if precision == "single" else 1e-12
    assert a["constraint"] == pytest.approx(C, rel=rel)
    assert a["multiplier"] == pytest.approx(lam, rel=rel)
    # grad W of the left one points right, towards its partner
    assert a["correction"][0] == pytest.approx(0.8 / m * push * np.array([g, -g]), rel=rel)


@everywhere
def test_one_sided_never_pulls(backend):
    a = arrays([[0, 0, 0], [D, 0, 0]])
    run("pbf_lambda", backend, a, pbf_tuple(minimum_error=0.0))
    assert (a["constraint"] < 0).all() and (a["multiplier"] == 0).all()


@everywhere
def test_walls_push_and_never_pull(backend):
    """Beside a wall, thin liquid is left alone; where it is too dense the wall pushes with lambda_i V_j alone."""
    R = 2.2 * D
    g = 45 / (np.pi * R**4 * lattice_sums(2.2).gradient) * 0.25
    for lam in (0.5 / d0(2.2), -0.5 / d0(2.2)):
        a = arrays([[0, 0, 0], [0.5 * R, 0, 0]], [0, 2], multiplier=[lam, 0])
        c = run("pbf_correction", backend, a, iteration=0)["correction"]
        assert c[0, 0] == pytest.approx(min(lam, 0) * D**3 * g / MASS, rel=1e-12)
        assert (c[1:] == 0).all() and c[0, 1] == 0


@everywhere
def test_isolated_without_softening_has_no_multiplier(backend):
    a = arrays([[0, 0, 0]])
    run("pbf_lambda", backend, a, pbf_tuple(softening=0.0))
    run("pbf_correction", backend, a, pbf_tuple(softening=0.0), iteration=0)
    assert a["multiplier"].tolist() == [0] and (a["correction"] == 0).all()


@everywhere
@pytest.mark.parametrize("iteration", [0, 1, 2, 3])
@pytest.mark.parametrize("precision", REALS)
def test_momentum_with_unequal_masses_radii_and_iterations(backend, precision, iteration):
    """V8: sum m Dp = 0 in every iteration; multipliers of particles off the list are poison and must not matter."""
    rng = np.random.default_rng(8)
    n = 300
    x = rng.uniform(0, 1, (n, 3)) * np.array([12, 5, 5]) * D
    m = rng.uniform(0.2, 5, n) * MASS
    a = arrays(
        x, 0, precision, mass=m, mobility=1 / m, volume=rng.uniform(0.5, 1.5, n) * D**3,
        support_radius=rng.uniform(1.6, 2.2, n) * D, iterations=1 + (x[:, 0] / (3 * D)).astype(int), multiplier=np.full(n, np.nan),
        velocity=rng.normal(size=(3, n)),
    )
    real = a["mass"].dtype.type
    pbf = pbf_tuple(real=real, uniform=0, push=0.1 / d0(2.2))
    run("pbf_list", backend, a, pbf)
    run("iteration_key", backend, a, pbf)
    run("active_list", backend, a, iteration=iteration)
    on = a["active_index"][: a["active_count"][0]]
    assert (iteration == 0) == (len(on) == n)
    run("pbf_lambda", backend, a, pbf)
    run("pbf_correction", backend, a, pbf, iteration=iteration)
    limit = 1e-14 if precision == "double" else 1e-6
    dp = a["mass"].astype(float)[on] * a["correction"].astype(float)[:, on]
    assert np.isfinite(dp).all() and np.abs(dp).max() > 0
    assert np.abs(dp.sum(axis=1)).max() <= limit * np.abs(dp).sum()
    before = a["velocity"].astype(float)
    dv = run("pbf_xsph", backend, a, pbf, dt=0.01)["velocity_next"].astype(float) - before
    p = a["mass"] * dv
    assert np.abs(p.sum(axis=1)).max() <= limit * np.abs(p).sum() and np.abs(p).max() > 0


def periodic_error(eps_rel, iterations, ratio=2.2, n=8):
    """R.m.s. C (per cent) of a jittered periodic lattice after 0, 1 ... iterations: images around a core of n^3."""
    rng = np.random.default_rng(5)
    pad = 3
    cells = np.indices((n + 2 * pad,) * 3).reshape(3, -1) - pad
    home = np.ravel_multi_index(tuple(cells % n), (n,) * 3)
    core = np.flatnonzero(((cells >= 0) & (cells < n)).all(axis=0))
    own = np.zeros(n**3, int)
    own[home[core]] = core
    jitter = rng.uniform(-0.15, 0.15, (3, n**3)) * D
    x = (cells + 0.5) * D
    a = arrays((x + jitter[:, home]).T, active_index=np.pad(core, (0, cells.shape[1] - len(core))), active_count=[len(core)])
    a["multiplier"][:] = 0
    pbf = pbf_tuple(ratio, softening=eps_rel * d0(ratio), push=0.1 / d0(ratio))
    found = []
    for _ in range(iterations + 1):
        run("pbf_lambda", "cpu", a, pbf)
        found.append(100 * np.sqrt((a["constraint"][core] ** 2).mean()))
        a["multiplier"] = np.ascontiguousarray(a["multiplier"][own[home]])
        run("pbf_correction", "cpu", a, pbf, iteration=0)
        run("pbf_move", "cpu", a)
        shift = a["position"][:, core] - x[:, core]
        a["position"] = np.ascontiguousarray(x + shift[:, np.argsort(home[core])][:, home])
    return np.array(found)


def test_jittered_lattice_converges_as_measured():
    """V5: 3.6, 1.46, 0.80, 0.46, 0.33 % after 0, 1, 2, 4, 8 iterations, each within 20 %."""
    error = periodic_error(1.0, 8)
    assert error[[0, 1, 2, 4, 8]] == pytest.approx([3.6, 1.46, 0.80, 0.46, 0.33], rel=0.2)
    assert (np.diff(error) < 0).all()


def test_textbook_softening_diverges():
    """V5: with eps_rel = 0.01 at R = 2.2 d (omega' Lmax = 2.95) the error grows beyond 8 % in 4 iterations."""
    assert periodic_error(0.01, 4)[-1] > 8


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_free_fall_is_exact(backend, precision):
    """An isolated particle keeps v + dt g to the last bit, whatever its distance from the origin."""
    a = arrays([[1.3, -0.7, 2.9]], 0, precision, velocity=[[0.3], [-0.1], [0.2]])
    real, dt = a["mass"].dtype.type, 1e-3
    v = a["velocity"].copy()
    for _ in range(5):
        v[2] += real(dt) * real(-9.81)
        run("pbf_predict", backend, a, dt=dt, gravity=-9.81)
        run("pbf_lambda", backend, a)
        run("pbf_correction", backend, a, iteration=0)
        run("pbf_move", backend, a)
        run("pbf_velocity", backend, a, dt=dt)
    assert np.abs(a["velocity"] - v).max() <= (np.spacing(np.abs(v)).max() if backend == "reference" else 0)


@everywhere
def test_prediction_cuts_speed_and_stops_at_the_vessel(backend):
    a = arrays([[0.5 * D, 0, 0], [0, 0, 0], [0, 9 * D, 0]], [0, 0, 2], velocity=[[-2.0, 3, 5], [0, 4, 5], [0, 0, 5]])
    run("pbf_predict", backend, a, dt=0.01, vessel=vessel_tuple(lower_x=0.25 * D))
    # d/(2 dt) = 1 m/s: v = (-1, 0, 0) and (0.6, 0.8, 0)
    assert a["velocity"].T == pytest.approx(np.array([[-1, 0, 0], [0.6, 0.8, 0], [5, 5, 5]]), rel=1e-14)
    assert a["position"].T == pytest.approx(np.array([[0.25 * D, 0, 0], [0.006, 0.008, 0], [0, 9 * D, 0]]))
    assert a["position_predicted"][0] == pytest.approx([0, 0.006, 0], abs=1e-17)
    # the wall takes the velocity that it stopped
    run("pbf_velocity", backend, a, dt=0.01)
    assert a["velocity"][0] == pytest.approx([-1 + 0.25 * D / 0.01, 0.6, 5])


@everywhere
@pytest.mark.parametrize("precision", REALS)
def test_a_correction_is_half_a_spacing_long_at_most(backend, precision):
    c = np.array([[0.3, 0.4, 0], [0.3, 0.4, 0.01], [0, -30, 40], [np.nan, 0, 0], [9, 0, 0]]).T * D
    a = arrays(np.zeros((5, 3)), 0, precision, correction=c, active_index=[0, 1, 2, 3, 4], active_count=[4])
    run("pbf_move", backend, a)
    rel = 1e-14 if precision == "double" else 1e-6  # corrections are float32
    size = np.sqrt(0.2501)
    assert a["position"][:, :3].T / D == pytest.approx(
        np.array([[0.3, 0.4, 0], [0.15 / size, 0.2 / size, 0.005 / size], [0, -0.3, 0.4]]), rel=rel, abs=1e-300
    )
    assert np.isnan(a["position"][0, 3]) and (a["position"][:, 4] == 0).all()  # not listed


@everywhere
def test_coincident_particles_part(backend):
    """Two at one place get opposite pushes of equal impulse; a thousand are finite and all differ."""
    m = np.array([1.0, 3.0, 1.0]) * MASS
    a = arrays([[D, D, D], [D, D, D], [2 * D, D, D]], mass=m, mobility=1 / m)
    c = run("pbf_separate", backend, a)["correction"]
    assert (c[:, 2] == 0).all()
    assert c[:, 0] == pytest.approx(-3 * c[:, 1], rel=1e-13)
    assert np.linalg.norm(c[:, 0] - c[:, 1]) == pytest.approx(0.01 * D, rel=1e-13)


@pytest.mark.parametrize("precision", REALS)
def test_many_coincident_particles_stay_finite(precision):
    n = 200
    a = arrays(np.zeros((n, 3)), 0, precision)
    pbf = pbf_tuple(real=a["mass"].dtype.type, push=0.1 / d0(2.2))
    run("pbf_separate", "cpu", a, pbf)
    run("pbf_move", "cpu", a, pbf)
    assert len(np.unique(a["position"].T, axis=0)) == n
    for k in range(4):
        run("pbf_lambda", "cpu", a, pbf)
        run("pbf_correction", "cpu", a, pbf, iteration=k)
        run("pbf_move", "cpu", a, pbf)
    assert np.isfinite(a["position"]).all()


@pytest.mark.parametrize("backend", BACKENDS)
def test_nothing_is_fine(backend):
    a = arrays(np.zeros((0, 3)))
    for stage in ("pbf_begin", "pbf_list", "pbf_separate", "iteration_key", "pbf_lambda", "pbf_move", "vorticity_curl"):
        run(stage, backend, a)
    for stage in ("pbf_correction", "active_list"):
        run(stage, backend, a, iteration=0)
    for stage in ("pbf_predict", "pbf_velocity", "vorticity_force", "pbf_xsph"):
        run(stage, backend, a, dt=0.01)
    run("effect_precision", backend, a, height=0.1, dt=0.01)
    assert run("height_histogram", backend, a)["height_bins"].sum() == 0
    assert (run("pbf_bounds", backend, a)["pbf_bounds"] == 0).all()
