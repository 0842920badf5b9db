"""Heat of the boiling liquid: eqs (10), (11), heater, surface, latent store (boiling 2.3, 3, V11)."""

import numpy as np
import pytest
from boil_cases import ALPHA, C_P, run
from liquid_cases import both, everywhere
from pbf_cases import MASS, D, arrays, lattice, pbf_tuple

R = 2.2 * D
PAIR = [[0, 0, 0], [D, 0, 0]]


def lap(r, support=R):
    """lap W3 [1/m^5]."""
    return 45 / (np.pi * support**6) * max(support - r, 0)


def close(precision, double=1e-12, single=1e-5):
    return double if precision == "double" else single


@everywhere
@both
def test_sum_of_a_pair_and_of_the_lattice(backend, precision):
    """theta = (1/6) V r^2 lap W3; inside the lattice it is N_L of the spec's table."""
    a = arrays([*PAIR, [0, D, 0]], [0, 0, 2], precision)
    th = run("boil_sums", backend, a, pbf_tuple(real=a["mass"].dtype.type))["heat_sum"]
    assert th[:2] == pytest.approx(D**5 * lap(D) / 6, rel=close(precision)) and th[2] == 0
    for ratio, n_l, layers in ((1.6, 1.14674, 5), (2.0, 0.98812, 5), (2.2, 0.88624, 5), (2.5, 1.02122, 7)):
        a = arrays(lattice(layers), 0, precision, ratio)
        th = run("boil_sums", backend, a, pbf_tuple(ratio, a["mass"].dtype.type))["heat_sum"]
        assert th[layers**3 // 2] == pytest.approx(n_l, abs=6e-6 if precision == "double" else 2e-5)
        assert th[0] < 0.5 * n_l  # a corner


@everywhere
@both
def test_exchange_of_a_pair_does_not_depend_on_the_kernel(backend, precision):
    """Alone, V L = 6/r^2: each takes 6 alpha dt/d^2 = 0.15 of the difference. Walls and bubbles keep theirs."""
    x = [*PAIR, [0, D, 0], [0, -D, 0], [D, D, 0]]
    a = arrays(x, [0, 0, 2, 3, 5], precision, temperature=[20.0, 100, 500, 700, 900])
    pbf = pbf_tuple(real=a["mass"].dtype.type)
    run("boil_sums", backend, a, pbf)
    T = run("boil_exchange", backend, a, pbf, dt=0.01)["temperature_next"]
    assert T == pytest.approx([32, 88, 500, 700, 900], rel=close(precision))
    rate = run("boil_rate", backend, a, pbf)["heat_rate"]
    assert rate.max() == pytest.approx(6 * ALPHA / D**2, rel=close(precision))


@everywhere
@both
def test_exchange_without_correction(backend, precision):
    """(10): dT_i/dt = alpha sum_j V_j/(1 + C_j) lap W3 (T_j - T_i)."""
    a = arrays(PAIR, 0, precision, temperature=[20.0, 100], constraint=[0.25, -0.2])
    pbf = pbf_tuple(real=a["mass"].dtype.type)
    a["heat_sum"] = a["heat_sum"][:0]  # not there in this model
    T = run("boil_exchange", backend, a, pbf, dt=0.01, corrected=0)["temperature_next"]
    part = 0.01 * ALPHA * D**3 * lap(D) * np.array([1 / 0.8, 1 / 1.25])
    assert T == pytest.approx(np.array([20, 100]) + part * [80, -80], rel=close(precision))
    rate = run("boil_rate", backend, a, pbf, corrected=0)["heat_rate"]
    assert rate.max() == pytest.approx(part.max() / 0.01, rel=close(precision))


@everywhere
def test_a_pair_uses_the_mean_radius(backend):
    """Beyond (R_i + R_j)/2 there is no exchange; within it, theta takes lap W3 of that radius."""
    x, radii = [[0, 0, 0], [1.9 * D, 0, 0], [0, 1.95 * D, 0]], np.array([1.6, 2.2, 2.4]) * D
    a = arrays(x, 0, ratio=2.6, support_radius=radii, temperature=[0.0, 50, 80])
    run("boil_sums", backend, a, pbf_tuple(2.6, uniform=0))
    th = D**3 / 6 * (1.95 * D) ** 2 * lap(1.95 * D, 2.0 * D)
    assert a["heat_sum"] == pytest.approx([th, 0, th], rel=1e-11)
    T = run("boil_exchange", backend, a, pbf_tuple(2.6, uniform=0), dt=0.01)["temperature_next"]
    part = 0.01 * ALPHA * 6 / (1.95 * D) ** 2
    assert T == pytest.approx([80 * part, 50, 80 - 80 * part], rel=1e-11)


@everywhere
def test_pairs_that_hardly_meet_do_not_conduct(backend):
    """theta_i + theta_j < 1e-6: at the support, at one point, and alone."""
    x = [[0, 0, 0], [R * (1 - 1e-9), 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0]]
    a = arrays(x, 0, temperature=[20.0, 100, 20, 100, 60])
    run("boil_sums", backend, a)
    assert 0 < a["heat_sum"][0] < 1e-6 and (a["heat_sum"][2:] == 0).all()
    assert run("boil_exchange", backend, a, dt=0.01)["temperature_next"].tolist() == [20, 100, 20, 100, 60]
    assert (run("boil_rate", backend, a)["heat_rate"] == 0).all()


@everywhere
def test_rate_is_the_largest_of_each_piece(backend):
    """130 pairs: particles 2 k and 2 k + 1 stand (1 + k/130) spacings apart; a NaN shows as infinity."""
    k = np.arange(130)
    near = np.column_stack([k, 0 * k, 0 * k]) * 1.0
    x = np.stack([near, near + np.column_stack([(1 + k / 130) * D, 0 * k, 0 * k])], axis=1).reshape(-1, 3)
    a = arrays(x)
    run("boil_sums", backend, a)
    rate = run("boil_rate", backend, a)["heat_rate"]
    each = 6 * ALPHA / ((1 + k / 130) * D) ** 2
    first = [int(p * 260 // 64 // 2) for p in range(64)]  # the pair at the start of a piece is its closest
    assert rate == pytest.approx(each[first], rel=1e-9)
    a["heat_sum"][101] = np.nan
    rate = run("boil_rate", backend, a)["heat_rate"]
    assert np.flatnonzero(rate == np.inf).tolist() == [24, 25]  # its partner 100 ends piece 24, it begins 25
    assert np.isfinite(np.delete(rate, [24, 25])).all()


@everywhere
@both
def test_heater_warms_what_touches_it(backend, precision):
    """Below the contact height, over the rectangle with its edges, liquid only; the ledger gets what is stored."""
    x = [[0, D, 0.5 * D], [2 * D, -D, 0.99 * D], [D, 0, D], [2.1 * D, 0, 0], [D, 1.1 * D, 0], [D, 0, 0], [D, 0, 0], [D, 0, 0]]
    phase, T0 = [0, 0, 0, 0, 0, 1, 3, 0], np.array([20.0, 90, 20, 20, 20, 20, 20, 130])
    for share in (0.25, 1.0):
        a = arrays(x, phase, precision, temperature=T0)
        before = a["temperature"].astype(float)
        out = run("boil_heater", backend, a, target=115.3, share=share)
        T = T0 + np.isin(np.arange(8), (0, 1, 7)) * share * (115.3 - T0)
        assert out["temperature"] == pytest.approx(T, rel=close(precision, 1e-14, 2e-7))
        if share == 1:
            assert (out["temperature"][[0, 1, 7]] == a["mass"].dtype.type(115.3)).all()
        gained = (a["mass"].astype(float) * float(a["mass"].dtype.type(C_P)) * (out["temperature"].astype(float) - before)).sum()
        assert out["heater_heat"].dtype == np.float64
        assert out["heater_heat"].sum() == pytest.approx(gained, rel=1e-14)


@everywhere
def test_ledger_takes_what_rounding_left(backend):
    """A gain below the last digit is no gain; the sum of many small ones is what the content grew by."""
    a = arrays([[D, 0, 0]], temperature=[115 - 1e-13])
    run("boil_heater", backend, a, target=115.0, share=0.01)
    assert a["heater_heat"].sum() == 0
    n = 300
    rng = np.random.default_rng(4)
    a = arrays(np.column_stack([np.full(n, D), 0 * np.arange(n), np.arange(n) * 1e-5]), 0, "single", temperature=rng.uniform(20, 115, n))
    start = run("boil_content", backend, a)["boil_content"].sum()
    total = 0.0
    for _ in range(20):
        total += run("boil_heater", backend, a, target=115.0, share=0.02)["heater_heat"].sum()
    assert run("boil_content", backend, a)["boil_content"].sum() - start == pytest.approx(total, rel=1e-11)


@everywhere
@both
def test_surface_loses_heat(backend, precision):
    a = arrays([[0, 0, 3 * D], [0, 0, 3.01 * D], [9, 9, 5 * D], [0, 0, 4 * D]], [0, 0, 0, 2], precision, temperature=[80.0] * 4)
    out = run("boil_cooling", backend, a, target=20.0, share=0.1, height=3.005 * D)
    assert out["temperature"] == pytest.approx([80, 74, 74, 80], rel=1e-6)
    assert out["lost_heat"].sum() == pytest.approx(2 * MASS * C_P * 6, rel=close(precision)) and out["lost_heat"].dtype == np.float64


@everywhere
@both
def test_store_takes_what_is_above_the_boiling_point(backend, precision):
    T, store = [100.5, 100.0, 99.5, 150.0, 100.25], [10.0, 20, 30, 40, 0]
    a = arrays(np.arange(15).reshape(5, 3), [0, 0, 0, 2, 0], precision, temperature=T, latent_store=store)
    before = run("boil_content", backend, a)["boil_content"].sum()
    by_hand = MASS * sum(C_P * T[k] + store[k] for k in (0, 1, 2, 4))
    assert before == pytest.approx(by_hand, rel=close(precision, 1e-14, 1e-6))
    run("boil_store", backend, a)
    assert a["temperature"].tolist() == [100, 100, 99.5, 150, 100]
    assert a["latent_store"] == pytest.approx([10 + 0.5 * C_P, 20, 30, 40, 0.25 * C_P], rel=1e-6)
    assert run("boil_content", backend, a)["boil_content"].sum() == pytest.approx(before, rel=close(precision, 1e-15, 1e-7))


def cloud(precision="double", n=6, seed=5):
    """A jittered block with free faces, radii of its own for each particle, temperatures from 20 to 100."""
    rng = np.random.default_rng(seed)
    x = lattice(n) + rng.uniform(-0.2, 0.2, (n**3, 3)) * D
    radii = rng.uniform(1.8, 2.2, n**3) * D
    return arrays(x, 0, precision, support_radius=radii, temperature=rng.uniform(20, 100, n**3), constraint=rng.normal(size=n**3) * 0.05)


@everywhere
@pytest.mark.parametrize("corrected", (1, 0))
def test_range_holds_up_to_the_step_limit(backend, corrected):
    """V11: with dt from `boil_rate` at its limit no temperature leaves its range, and (11) keeps the heat."""
    a, pbf = cloud(), pbf_tuple(uniform=0)
    run("boil_sums", backend, a, pbf)
    dt = 1 / run("boil_rate", backend, a, pbf, corrected=corrected)["heat_rate"].max()
    low, high, start = a["temperature"].min(), a["temperature"].max(), a["temperature"].sum()
    for _ in range(5):
        a["temperature"] = run("boil_exchange", backend, a, pbf, dt=dt, corrected=corrected)["temperature_next"]
        assert low - 1e-12 <= a["temperature"].min() and a["temperature"].max() <= high + 1e-12
    lost = abs(a["temperature"].sum() / start - 1)
    assert lost <= 1e-14 if corrected else lost > 1e-6  # (10) is not symmetric


def test_beyond_the_step_limit_temperatures_overshoot():
    a = arrays(PAIR, temperature=[20.0, 100])
    run("boil_sums", "cpu", a)
    rate = run("boil_rate", "cpu", a)["heat_rate"].max()
    T = run("boil_exchange", "cpu", a, dt=1.01 / rate)["temperature_next"]
    assert T.max() > 100 and T.min() < 20


@pytest.mark.parametrize("precision, drift", (("double", 1e-12), ("single", 2e-6)))
def test_heat_is_kept_over_a_thousand_steps(precision, drift):
    """V11."""
    a = cloud(precision)
    real = a["mass"].dtype.type
    pbf = pbf_tuple(real=real, uniform=0)
    run("boil_sums", "cpu", a, pbf)
    dt = 0.8 / float(run("boil_rate", "cpu", a, pbf)["heat_rate"].max())
    start = run("boil_content", "cpu", a)["boil_content"].sum()
    low, high = a["temperature"].min(), a["temperature"].max()
    spread = np.ptp(a["temperature"])
    for _ in range(1000):
        a["temperature"] = run("boil_exchange", "cpu", a, pbf, dt=dt)["temperature_next"]
    assert abs(run("boil_content", "cpu", a)["boil_content"].sum() / start - 1) <= drift
    assert low <= a["temperature"].min() and a["temperature"].max() <= high
    assert np.ptp(a["temperature"]) < 1e-3 * spread
