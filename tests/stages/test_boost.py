"""What heat does to velocities: eq (12) and its alternatives (boiling 2.4, V12, V27)."""

import numpy as np
import pytest
from boil_cases import run
from liquid_cases import both, everywhere
from pbf_cases import MASS, D, arrays, lattice, pbf_tuple

from melt import params as P
from melt.physics.boiling import viscosity_ratio

NONE = dict(mean_u=0.0, mean_v=0.0, mean_w=0.0, mean_temperature=0.0)


def means(backend, a):
    """Return the total mass, and mean velocity and temperature by name, as the step page takes them."""
    m, *sums = run("liquid_sums", backend, a)["liquid_sums"].sum(axis=1)
    return m, dict(zip(NONE, (s / m for s in sums)))


@everywhere
@both
def test_sums_over_the_liquid(backend, precision):
    n = 200
    rng = np.random.default_rng(6)
    phase = rng.choice([0, 0, 0, 1, 2, 3, 5], n)
    m, T = rng.uniform(1, 2, n), rng.uniform(20, 100, n)
    a = arrays(rng.uniform(0, 9, (n, 3)), phase, precision, mass=m, velocity=rng.normal(size=(3, n)), temperature=T)
    out = run("liquid_sums", backend, a)["liquid_sums"]
    on = a["phase"] == 0
    m, v, T = (a[name].astype(float) for name in ("mass", "velocity", "temperature"))
    right = np.array([m, *(m * v), m * T])[:, on].sum(axis=1)
    assert out.dtype == np.float64 and out.sum(axis=1) == pytest.approx(right, rel=1e-13)
    part = on[: n * 10 // 64]  # pieces in order
    assert out[0, :10].sum() == pytest.approx(m[: len(part)][part].sum(), rel=1e-13)


@everywhere
@both
def test_one_step_of_each_mode_by_hand(backend, precision):
    """theta = 0.5 at 60 C, 0 at 10 C, 1 at 130 C; walls keep their velocity."""
    T, v = [60.0, 10, 130, 60], np.array([[0.3, 0.3, 0.3, 0.3], [0, 0, 0.4, 0], [0, 0, 0, 0]])
    a = arrays(np.eye(4)[:, :3], [0, 0, 0, 2], precision, temperature=T, velocity=v)
    close = dict(rel=1e-13, abs=1e-15) if precision == "double" else dict(rel=1e-6, abs=1e-7)
    mean = dict(mean_u=0.1, mean_v=0.0, mean_w=-0.2, mean_temperature=50.0)

    def boosted(**mode):
        b = dict(a)
        return run("boost", backend, b, dt=0.01, **mean, **mode)["velocity"]

    # |v - mean|^2 = 0.08, 0.24: s = 1 + k theta dt (1 - ./0.25)
    right = v + 0
    for i, f in ((0, 2 * 0.5 * 0.01 * (1 - 0.08 / 0.25)), (2, 2 * 0.01 * (1 - 0.24 / 0.25))):
        right[:, i] += f * (v[:, i] - [0.1, 0, -0.2])
    assert boosted(boost=P.BOOST_RATE, boost_rate=2.0) == pytest.approx(right, **close)
    right = v * [1 + 0.3 * 0.5, 1, 1.3, 1]
    assert boosted(boost=P.BOOST_LITERAL, boost_rate=0.3) == pytest.approx(right, **close)
    right = v - np.array([[0.5], [0], [-9.81]]) * 0.01 * 2e-3 * (np.array(T) - 50) * [1, 1, 1, 0]
    got = boosted(boost=P.BOOST_BOUSSINESQ, expansion=2e-3, gravity_x=0.5, gravity_z=-9.81)
    assert got == pytest.approx(right, **close) and got[2, 2] > 0 > got[2, 1]  # what is warm rises
    for mode in (P.BOOST_OFF, P.BOOST_VISCOSITY):
        assert boosted(boost=mode, boost_rate=2.0).tobytes() == a["velocity"].tobytes()


@everywhere
def test_the_boost_never_brakes_and_stops_at_its_speed(backend):
    v = np.array([[0.5, 0.6, 0.4999], [0, 0, 0], [0, 0, 0]])
    a = arrays(np.eye(3), temperature=[100.0] * 3, velocity=v)
    out = run("boost", backend, a, dt=0.1, boost=P.BOOST_RATE, boost_rate=1.0, boost_speed=0.5, **NONE)["velocity"]
    assert (out[0, :2] == v[0, :2]).all() and 0.4999 < out[0, 2] < 0.5


@everywhere
def test_boiling_point_not_above_the_start(backend):
    """theta is a step where T_0 >= T_b."""
    a = arrays(np.eye(3), temperature=[99.0, 100, 101], velocity=np.ones((3, 3)))
    out = run("boost", backend, a, dt=0.1, boost=P.BOOST_LITERAL, boost_rate=1.0, start_temperature=100.0, **NONE)
    assert out["velocity"][0].tolist() == [1, 2, 2]


@pytest.mark.parametrize("backend", ("cpu", "cuda-emulated"))
def test_speed_follows_the_logistic_law(backend):
    """V27: v = v_b / sqrt(1 + (v_b^2/v_0^2 - 1) exp(-2 k theta t)) within 1 %, at 240 Hz, theta = 0.75, over 8 s."""
    a = arrays([[0, 0, 0]], temperature=[80.0], velocity=[[0.03], [0], [0.04]])
    dt, worst = 1 / 240, 0.0
    for step in range(1, 1921):
        run("boost", backend, a, dt=dt, boost=P.BOOST_RATE, **NONE)
        right = 0.5 / np.sqrt(1 + (0.5**2 / 0.05**2 - 1) * np.exp(-2 * 0.5 * 0.75 * step * dt))
        worst = max(worst, abs(np.linalg.norm(a["velocity"]) / right - 1))
    assert worst <= 0.01 and np.linalg.norm(a["velocity"]) > 0.4
    assert a["velocity"][2, 0] / a["velocity"][0, 0] == pytest.approx(4 / 3, rel=1e-12)


@everywhere
@pytest.mark.parametrize("precision, error", (("double", 1e-12), ("single", 2e-6)))
def test_boost_and_shift_keep_the_momentum(backend, precision, error):
    """V27: what the boost brings in is taken out again with the mean."""
    n = 120
    rng = np.random.default_rng(8)
    phase = rng.choice([0, 0, 0, 2], n)
    a = arrays(
        rng.uniform(0, 1, (n, 3)), phase, precision, mass=rng.uniform(0.5, 2, n) * MASS,
        velocity=rng.normal(size=(3, n)) * 0.2 + 0.3, temperature=rng.uniform(20, 100, n),
    )
    before, walls = a["velocity"].copy(), a["velocity"][:, a["phase"] == 2].tobytes()
    mass, start = means(backend, a)
    run("boost", backend, a, dt=0.5, boost=P.BOOST_RATE, **start)
    _, after = means(backend, a)
    assert abs(after["mean_u"] - start["mean_u"]) > 1e-4  # there is something to take out
    run("shift_velocity", backend, a, **{k: after[k] - start[k] for k in ("mean_u", "mean_v", "mean_w")})
    _, end = means(backend, a)
    size = np.abs(before).mean()
    assert max(abs(end[k] - start[k]) for k in ("mean_u", "mean_v", "mean_w")) <= error * size
    assert a["velocity"][:, a["phase"] == 2].tobytes() == walls
    assert (np.abs(a["velocity"] - before)[:, a["phase"] == 0] > 0).any(axis=0).mean() > 0.9


def test_viscosity_of_water():
    """Vogel's formula against tables of water (mPa s, saturated liquid): within 0.6 % from 20 to 100 C, 3.2 % at 0 C."""
    table = {20: 1.002, 30: 0.7977, 40: 0.6532, 50: 0.5470, 60: 0.4665, 70: 0.4040, 80: 0.3544, 90: 0.3145, 100: 0.2818}
    for T, mu in table.items():
        assert viscosity_ratio(float(T)) == pytest.approx(mu / 1.002, rel=0.006)
    assert viscosity_ratio(20.0) == 1 and viscosity_ratio(100.0) == pytest.approx(0.2827, abs=5e-5)
    assert viscosity_ratio(0.0) == pytest.approx(1.793 / 1.002, rel=0.034) == viscosity_ratio(-300.0)


@everywhere
@pytest.mark.parametrize("precision", ("single", "mixed", "double"))
def test_at_20_degrees_the_blend_is_that_of_pbf(backend, precision):
    rng = np.random.default_rng(9)
    x = lattice(4) + rng.uniform(-0.2, 0.2, (64, 3)) * D
    phase, v = rng.choice([0, 0, 0, 2], 64), rng.normal(size=(3, 64))
    m = rng.uniform(0.5, 2, 64) * MASS
    for uniform in (1, 0):
        a = arrays(x, phase, precision, velocity=v, mass=m, temperature=np.where(phase == 0, 20.0, 1e4))
        pbf = pbf_tuple(real=a["mass"].dtype.type, uniform=uniform)
        plain = run("pbf_xsph", backend, dict(a), pbf, dt=0.004)["velocity_next"]
        warm = run("boost_xsph", backend, dict(a), pbf, dt=0.004)["velocity_next"]
        assert np.abs(warm - plain).max() <= (1e-15 if precision == "double" else 3e-7) and (warm != v).any()


@everywhere
def test_a_pair_blends_by_the_mean_of_its_viscosities(backend):
    """c V W (mu(20) + mu(100))/2 of the difference, in momentum exact."""
    m = np.array([1.0, 3.0]) * MASS
    a = arrays([[0, 0, 0], [D, 0, 0]], mass=m, velocity=[[0.0, 1], [0, 0], [0, 0]], temperature=[20.0, 100])
    v = run("boost_xsph", backend, a, pbf_tuple(blend=12.0), dt=0.005)["velocity_next"]
    W = 315 / (64 * np.pi * 2.2**3) * (1 - 1 / 2.2**2) ** 3  # V W
    c = 0.06 * (1 + np.exp(578.919 / 235.604 - 578.919 / 155.604)) / 2
    assert v[0] == pytest.approx([c * 2 * 0.75 * W, 1 - c * 2 * 0.25 * W], rel=1e-12)
    assert (m * v[0]).sum() == pytest.approx(m[1], rel=1e-15)


@everywhere
@pytest.mark.parametrize("T, ratio", ((20.0, 1.0), (60.0, 0.46728), (100.0, 0.28272)))
def test_shear_wave_in_warm_water_decays_slower(backend, T, ratio):
    """V12: 1 - c mu(T)/mu(20 C) sum V W1 (1 - cos k dz)."""
    n, c = 32, 0.05
    x = lattice(7, 7, n + 6)
    k = 2 * np.pi / (n * D)
    wave = np.cos(k * (x[:, 2] - 3 * D))
    a = arrays(x, velocity=np.array([wave, 0 * wave, 0 * wave]), temperature=np.full(len(x), T))
    out = run("boost_xsph", backend, a, pbf_tuple(blend=c / 0.01), dt=0.01)["velocity_next"][0]
    middle = (np.abs(x[:, :2] - 3.5 * D) < 0.1 * D).all(axis=1) & (x[:, 2] > 3 * D) & (x[:, 2] < (n + 3) * D)
    offset = np.indices((7, 7, 7)).reshape(3, -1).T - 3
    r = np.sqrt((offset**2).sum(axis=1)) / 2.2
    W = 315 / (64 * np.pi * 2.2**3) * np.where(r < 1, 1 - r**2, 0) ** 3
    mu = np.exp(578.919 / (T + 273.15 - 137.546) - 578.919 / 155.604)
    assert mu == pytest.approx(ratio, abs=1e-5)
    factor = 1 - c * mu * (W * (1 - np.cos(k * D * offset[:, 2]))).sum()
    assert middle.sum() == n and np.abs(out[middle] - factor * wave[middle]).max() <= 1e-12
