"""Pair updates of eq (4): the numbers of the specification, conservation, bounds, extremes."""

import numpy as np
import pytest
from heat_bench import BACKENDS, cells, constants, emulate_cuda, pairs, particles, solve  # noqa: F401

TWO = [[0.1, 0.1, 0.1], [0.3, 0.1, 0.1]]
CHAIN = [[0.02, 0.1, 0.1], [0.22, 0.1, 0.1], [0.42, 0.1, 0.1]]
SWEEPS = ("heat_pairs_seq", "heat_pairs_coloured")
everywhere = pytest.mark.parametrize("backend", BACKENDS)
sweeps = pytest.mark.parametrize("name", SWEEPS)


@everywhere
@sweeps
def test_two_particles_two_halves(name, backend):
    T, _ = pairs(name, backend, particles(TWO, [-10, 40]), constants())
    assert T == pytest.approx([-9.673215259, 39.673215259], abs=1e-9)


@everywhere
@sweeps
def test_two_particles_literal_full_sweeps(name, backend):
    T, _ = pairs(name, backend, particles(TWO, [-10, 40]), constants(full_sweep=1))
    assert T == pytest.approx([-9.352796187, 39.352796187], abs=1e-9)


@everywhere
def test_one_pass_of_the_one_sided_form(backend):
    # with one partner it is eq (4) as printed, for both particles: one pair with the full dt
    a = particles(TWO, [-10, 40])
    T = solve("heat_onesided", backend, a, constants())["temperature_next"]
    assert T == pytest.approx([-9.674276173, 39.674276173], abs=1e-9)
    half = solve("heat_onesided", backend, a, constants(dt=0.0025))["temperature_next"]
    assert half[0] == pytest.approx(-9.836070169, abs=1e-9)
    unequal = particles(TWO, [-10, 40], K=[0.3, 0.1], V=[0.008, 0.016])
    T = solve("heat_onesided", backend, unequal, constants())["temperature_next"]
    assert T == pytest.approx([-9.565701564, 39.782850782], abs=1e-9)


@everywhere
def test_one_sided_order_of_neighbours(backend):
    # chain 0, 1, 2: the middle one meets 0 first, or 2 first when reversed
    a, g = particles(CHAIN, [-10, 0, 40]), 0.6 * 0.005 * 0.008 * 275.0197417
    step = g / (1 + 2 * g)
    for reverse, partners in ((0, (-10, 40)), (1, (40, -10))):
        T = 0.0
        for T_j in partners:
            T += step * (T_j - T)
        out = solve("heat_onesided", backend, a, {**constants(), "reverse": np.float64(reverse)})
        assert out["temperature_next"][1] == pytest.approx(T, abs=1e-8)


@everywhere
@sweeps
def test_unequal_volumes(name, backend):
    # one pair update with the full dt: each half sweep is given dt, so undo the second by hand
    a = particles(TWO, [-10, 40], K=[0.3, 0.1], V=[0.008, 0.016])
    half, _ = pairs(name, backend, a, constants(dt=0.005))
    g = 0.4 * 0.0025 * 275.0197417
    T = np.array([-10.0, 40.0])
    for _ in range(2):
        q = g * (T[1] - T[0]) / (1 + g * 0.024)
        T += [0.016 * q, -0.008 * q]
    assert half == pytest.approx(T, abs=1e-8)
    assert 0.008 * half[0] + 0.016 * half[1] == pytest.approx(0.56, abs=1e-12)


@everywhere
@pytest.mark.parametrize("real", (np.float64, np.float32))
@sweeps
def test_huge_conductivity_equalises(name, backend, real):
    a = particles(TWO, [-10, 40], real, K=1e9, V=[0.008, 0.016])
    T, _ = pairs(name, backend, a, constants(real))
    assert T == pytest.approx([70 / 3, 70 / 3], rel=3e-6 if real is np.float32 else 1e-6)


@everywhere
def test_chain_in_lexicographic_order(backend):
    T, _ = pairs("heat_pairs_seq", backend, particles(CHAIN, [-10, 0, 40]), constants())
    assert T == pytest.approx([-9.824857509, 0.195428324, 39.629429184], abs=1e-9)
    assert T.sum() == pytest.approx(30, abs=1e-13)


@everywhere
@sweeps
def test_harmonic_law(name, backend):
    # k 2 and 6: kappa = 3; C_i 10 and 40 J/K
    a = particles(TWO, [0, 100], K=[2, 6], C=[10, 40])
    T, _ = pairs(name, backend, a, constants(law=1, dt=100.0))
    g = 3 * 50 * 0.008**2 * 275.0197417
    expected = np.array([0.0, 100.0])
    for _ in range(2):
        q = g * (expected[1] - expected[0]) / (1 + g * (1 / 10 + 1 / 40))
        expected += [q / 10, -q / 40]
    assert T == pytest.approx(expected, rel=1e-8)
    insulated = particles(TWO, [0, 100], K=[0, 6], C=[10, 40])
    T, _ = pairs(name, backend, insulated, constants(law=1, dt=100.0))
    assert (T == [0, 100]).all()


@everywhere
@sweeps
def test_walls_and_inactive(name, backend):
    x = [[0.1, 0.1, 0.1], [0.3, 0.1, 0.1], [0.2, 0.2, 0.1], [0.1, 0.2, 0.2]]
    a = particles(x, [10, 50, 90, 70], phase=[0, 2, 2, 5], V=[0.008, 0.008, 0, 0], C=[0.008, np.inf, 0.008, 0])
    T, _ = pairs(name, backend, a, constants(wall_fixed=1))
    assert T[1:] == pytest.approx([50, 90, 70], abs=0) and 10 < T[0] < 50


def cloud(n, real, seed=0, **options):
    """Random particles in cell order, phases and capacities mixed, some isolated, two coincident."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(0, 1.4, (n, 3))
    x[5] = x[6]
    x[0] = [0.0, 0.0, 0.0]
    x[1] = [0.5, 0.0, 0.0]  # exactly at the support of particle 0
    ijk = np.floor(x / 0.5).astype(int)
    top = ijk.max(axis=0) + 1
    x = x[np.argsort((ijk[:, 2] * top[1] + ijk[:, 1]) * top[0] + ijk[:, 0], kind="stable")]
    L = np.where(rng.random(n) < 0.7, 0.16, 0.0) if options.get("latent") else np.zeros(n)
    T = rng.uniform(-10, 40, n)
    on = (L > 0) & (rng.random(n) < 0.4)
    T[on] = 0
    a = particles(
        x, T, real, K=options.get("K", rng.uniform(0.1, 0.8, n)), V=rng.uniform(0.006, 0.012, n), L=L,
        point=np.where(L > 0, 0.0, np.inf), e=np.where(on, rng.random(n), (T > 0) * 1.0) * L,
        molten=rng.uniform(0.01, 0.02, n),
    )
    a, grid = cells(a)
    return a, constants(real, grid=grid, latent=int(bool(options.get("latent"))), dt=options.get("dt", 0.005))


def enthalpy(a, T, e, latent):
    """Sum of C (T - T_m) + latent energy, float64."""
    C, molten, T = (v.astype(float) for v in (a["heat_capacity"], a["heat_capacity_molten"], T))
    if not latent:
        return (C * T).sum()
    m = np.where(np.isfinite(a["latent_point"]), a["latent_point"], 0.0)
    changes = a["latent_capacity"] > 0
    return (np.where(changes & (m < T), molten, C) * (T - m) + np.where(changes, e, 0)).sum()


@pytest.mark.parametrize("backend", ("cpu", "cuda"))
@pytest.mark.parametrize("latent", (0, 1))
@pytest.mark.parametrize("real, limit", ((np.float64, 1e-13), (np.float32, 1e-5)))
@pytest.mark.parametrize("K", (0.5, 1e6, 1e30))
@sweeps
def test_conserves_and_stays_within_bounds(name, backend, latent, real, limit, K):
    a, p = cloud(203, real, latent=latent, K=K)
    T, e = pairs(name, backend, a, p)
    before = enthalpy(a, a["temperature"], a["latent_energy"].astype(float), latent)
    size = np.abs(a["heat_capacity"].astype(float) * a["temperature"]).sum()
    assert abs(enthalpy(a, T, e.astype(float), latent) - before) <= limit * size
    room = 1e-12 if real is np.float64 else 1e-4
    assert np.isfinite(T).all()
    assert T.min() >= a["temperature"].min() - room and T.max() <= a["temperature"].max() + room
    assert (T != a["temperature"]).any()


@everywhere
@pytest.mark.parametrize("latent", (0, 1))
@pytest.mark.parametrize("name", (*SWEEPS, "heat_onesided", "heat_explicit"))
def test_nothing_to_do_is_nothing_done(name, backend, latent):
    a, p = cloud(60, np.float32, latent=latent, K=0.0)
    T, e = pairs(name, backend, a, p)
    assert (T == a["temperature"]).all() and (not latent or (e == a["latent_energy"]).all())
    a, p = cloud(60, np.float32, latent=latent)
    a["temperature"][:] = 17.3
    a["latent_energy"] = a["latent_capacity"].copy()
    T, e = pairs(name, backend, a, p)
    assert (T == a["temperature"]).all() and (not latent or (e == a["latent_energy"]).all())


@everywhere
@pytest.mark.parametrize("name", (*SWEEPS, "heat_onesided", "heat_explicit", "heat_rate"))
def test_empty(name, backend):
    a, p = particles(np.zeros((0, 3)), []), constants()
    for array in solve(name, backend, a, p).values():
        assert array.shape[-1] in (0, 64) and not array.any()


@everywhere
def test_explicit_limit(backend):
    # two particles: sum of G / C = 2 K V L, positive for dt up to its inverse
    a = particles(TWO, [-10, 40])
    rate = solve("heat_rate", backend, a, constants())["heat_rate"].max()
    assert rate == pytest.approx(0.6 * 0.008 * 275.0197417, rel=1e-9)
    T = solve("heat_explicit", backend, a, constants(dt=1 / rate))["temperature_next"]
    assert T == pytest.approx([40, -10], abs=1e-9)
