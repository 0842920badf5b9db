"""Thermal properties, enthalpy of one particle and of one pair, heaters, ambient air."""

import numpy as np
import pytest
from heat_bench import BACKENDS, constants, emulate_cuda, pairs, particles  # noqa: F401

from melt.check.compare import run_stage
from melt.physics.heat import absorb, latent_heat

everywhere = pytest.mark.parametrize("backend", BACKENDS)
PAIR = [[0.1, 0.1, 0.1], [0.3, 0.1, 0.1]]
SWEEPS = ("heat_pairs_seq", "heat_pairs_coloured")


def matter(phase, material, **fields):
    """Return the arrays of the property stages: water 0 (freezes to 1), ice 1 (melts to 0), rock 2."""
    n = len(phase)
    a = dict(
        phase=np.array(phase, np.int32), material=np.array(material, np.int32), mass=np.full(n, 8.0),
        rest_volume=np.full(n, 0.008), volume=np.full(n, 0.006), density=np.full(n, 1250.0),
        material_conductivity=np.array([0.5, 2.0, 3.0]), material_specific_heat=np.array([4000.0, 2000.0, 800.0]),
        material_latent_heat=np.array([0.0, 3e5, 0.0]), material_melting_point=np.array([np.inf, 0.0, 900.0]),
        material_melts_to=np.array([-1, 0, -1], np.int32), material_freezes_to=np.array([1, -1, -1], np.int32),
        temperature=np.full(n, 5.0), latent_energy=np.zeros(n),
        **{f: np.zeros(n) for f in ("conductivity", "heat_volume", "heat_capacity", "heat_capacity_molten",
                                    "latent_point", "latent_capacity")},
    )
    a.update({name: np.asarray(v, float) for name, v in fields.items()})
    return a


@everywhere
def test_paper_and_physical_capacities(backend):
    a = matter([0, 1, 2, 5], [0, 1, 2, 0])
    out = run_stage("thermal_properties", backend, a, constants())
    assert out["conductivity"].tolist() == [0.5, 2.0, 3.0, 0.0]
    assert out["heat_volume"].tolist() == [0.008, 0.008, 0.0, 0.0]  # walls insulate, nobody is nobody
    assert out["heat_capacity"][:2].tolist() == [0.008, 0.008]
    out = run_stage("thermal_properties", backend, a, constants(law=1, wall_fixed=1, current_volume=1))
    assert out["heat_volume"] == pytest.approx([8 / 1250, 0.006, 0.008, 0])
    assert out["heat_capacity"].tolist() == [32000.0, 16000.0, np.inf, 0.0]


@everywhere
def test_latent_properties(backend):
    a = matter([0, 1, 2, 5, 1], [0, 1, 2, 0, 2], heat_capacity=[32000.0, 16000.0, 6400.0, 0, 6400.0],
               heat_volume=[0.008] * 5, latent_energy=[2.4e6, 0, 7, 0, np.inf])
    a["temperature"] = np.array([5.0, -5.0, 20, 20, 20])
    out = run_stage("latent_properties", backend, a, constants(law=1, latent=1))
    assert out["latent_point"].tolist() == [0, 0, np.inf, np.inf, np.inf]
    assert out["latent_capacity"].tolist() == [2.4e6, 2.4e6, 0, 0, 0]
    assert out["heat_capacity"].tolist() == [16000.0, 16000.0, 6400.0, 0, 6400.0]
    assert out["heat_capacity_molten"].tolist() == [32000.0, 32000.0, 6400.0, 0, 6400.0]
    assert out["temperature"].tolist() == [5, -5, 20, 20, 20]  # on their curves: untouched
    assert out["latent_energy"].tolist() == [2.4e6, 0, 7, 0, 0]


@everywhere
def test_states_off_the_curve_keep_their_enthalpy(backend):
    # hot ice melts in part: 16 kJ/K... above the point 32 kJ/K * 30 K = 0.96 MJ; cold water gives 16 kJ/K * 10 K
    a = matter([1, 0], [1, 0], heat_capacity=[16000.0, 32000.0], heat_volume=[0.008] * 2, latent_energy=[0, 2.4e6])
    a["temperature"] = np.array([30.0, -10.0])
    out = run_stage("latent_properties", backend, a, constants(law=1, latent=1))
    assert out["temperature"].tolist() == [0, 0]
    assert out["latent_energy"] == pytest.approx([0.96e6, 2.4e6 - 0.16e6])


@everywhere
def test_initial_latent_energy(backend):
    a = matter([0, 1, 0], [0, 1, 2], heat_capacity=[32000.0, 16000.0, 6400.0], heat_volume=[0.008] * 3)
    a["latent_energy"] = run_stage("latent_start", backend, a, {})["latent_energy"]
    out = run_stage("latent_properties", backend, a, constants(law=1, latent=1))
    assert out["latent_energy"][0] == 2.4e6 and out["latent_energy"][2] == 0


def test_absorb_follows_the_enthalpy_curve():
    T, e = -10.0, 0.0  # C 2 below, 4 above, L 30, point 0
    path = []
    for q in (10, 10, 10, 20, 8, -8, -40, -5):
        T, e = absorb(float(q), T, e, 0.0, 2.0, 4.0, 30.0)
        path.append((T, e))
    assert path == [(-5, 0), (0, 0), (0, 10), (0, 30), (2, 30), (0, 30), (-5, 0), (-7.5, 0)]
    assert absorb(200.0, -10.0, 0.0, 0.0, 2.0, 4.0, 30.0) == (37.5, 30)  # through the whole plateau at once
    assert absorb(5.0, 1.0, 0.0, 0.0, np.inf, np.inf, 30.0) == (1.0, 0.0)


def test_implicit_pair_stops_at_the_ends_of_the_plateau():
    # g -> inf: both end at the common temperature of the enthalpy balance, here exactly the point
    ice = (-10.0, 0.0, 0.0, 2.0, 4.0, 30.0)
    water = (8.0, 0.0, np.inf, 5.0, 5.0, 0.0)
    q = latent_heat(1e12, *ice, *water)
    assert q == pytest.approx(40.0)  # 20 to warm the ice, 20 of its 30 to melt: water arrives at 0
    # finite g: q = g (T_hot - T_cold) afterwards
    for g in (0.1, 1.0, 7.0):
        q = latent_heat(g, *ice, *water)
        T, _ = absorb(q, *ice)
        assert q == pytest.approx(g * ((8 - q / 5) - T), rel=1e-12)


@everywhere
@pytest.mark.parametrize("name", SWEEPS)
def test_plateau_holds_its_temperature(name, backend):
    a = particles(PAIR, [0, 20], L=[10, 0], point=[0, np.inf], e=[1, 0], molten=0.016)
    T, e = pairs(name, backend, a, constants(latent=1))
    g = 0.6 * 0.0025 * 0.008**2 * 275.0197417
    hot, q = 20.0, 0.0
    for _ in range(2):
        step = g * hot / (1 + g / 0.008)
        hot, q = hot - step / 0.008, q + step
    assert T == pytest.approx([0, hot], abs=1e-8) and T[0] == 0
    assert e[0] == pytest.approx(1 + q, rel=1e-10)


def heaters(**values):
    """Return a heater table: a box that heats, a sphere that fixes."""
    table = dict(
        heater_shape=np.array([0, 1], np.int32), heater_centre=np.array([[0.0, 1.0], [0.0, 0.0], [0.0, 0.0]]),
        heater_size=np.array([[0.1, 0.2], [0.1, 0.0], [0.1, 0.0]]), heater_mode=np.array([0, 1], np.int32),
        heater_value=np.array([500.0, 90.0]), heater_reach=np.array([0.05, 0.0]),
    )
    return {**table, **values}


@everywhere
def test_heaters(backend):
    x = [[0, 0, 0], [0.1, 0.1, 0.1], [0.15, 0, 0], [0.1, 0.14, 0.14], [1.0, 0.2, 0], [1.0, 0.21, 0], [0, 0, 0]]
    a = particles(x, 10, C=2.0, V=[0.5] * 6 + [0.0])
    out = run_stage("heat_source", backend, {**a, **heaters()}, constants(dt=0.1))
    # 500 W/m^3 * 0.5 m^3 * 0.1 s / 2 J/K = 12.5 K; the fourth is 0.0566 from the box, the last one insulated
    assert out["temperature"] == pytest.approx([22.5, 22.5, 22.5, 10, 90, 10, 10])
    assert np.isinf(out["heat_capacity"]).tolist() == [False] * 4 + [True, False, False]


@everywhere
def test_heaters_melt(backend):
    x = [[0, 0, 0], [1.0, 0, 0], [1.0, 0.1, 0]]
    a = particles(x, [-5, 0, 0], C=2.0, V=0.5, L=[30, 30, 30], point=[0, 0, 95], molten=4.0, e=[0, 4, 4])
    out = run_stage("heat_source", backend, {**a, **heaters()}, constants(dt=0.1, latent=1))
    assert out["temperature"].tolist() == [0, 90, 90]
    assert out["latent_energy"] == pytest.approx([15, 30, 0])


@everywhere
def test_ambient_air(backend):
    a = particles(np.eye(3), [100, 100, 100], C=2.0, V=0.5)
    a["neighbour_count"] = np.array([40, 80, 40], np.int32)
    a["surface"] = np.array([1, 1, 0], np.int32)
    p = constants(dt=10.0, ambient_transfer=3.0, spacing=2.0, ambient_area=2.5)
    out = run_stage("ambient_cooling", backend, a, p)
    b = 10 * 3 * 2.5 * 4 * 0.5 / 2  # dt h_c k_A dx^2 (1 - N/N_full) / C
    assert out["temperature"] == pytest.approx([(100 + 20 * b) / (1 + b), 100, 100])


@everywhere
def test_ambient_air_freezes(backend):
    a = particles(np.zeros((1, 3)), 0, C=2.0, V=0.5, L=30, point=0, e=30, molten=4.0)
    a["neighbour_count"], a["surface"] = np.array([40], np.int32), np.array([1], np.int32)
    p = constants(dt=0.01, ambient_transfer=3.0, spacing=2.0, ambient_temperature=-20, latent=1)
    out = run_stage("ambient_cooling", backend, a, p)
    assert out["temperature"] == 0 and out["latent_energy"] == pytest.approx(30 - 0.01 * 3 * 5 * 20)
