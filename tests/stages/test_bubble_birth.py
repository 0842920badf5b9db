"""Vaporisation: who boils, and the four bubbles of each (boiling 3; V2, V22)."""

import numpy as np
import pytest
from bubble_cases import BOILING, BUBBLES
from bubble_life_cases import BUBBLE, INACTIVE, LIQUID, listed, pool, run, same_bits, shuffled, slots_of
from liquid_cases import both, everywhere
from pbf_cases import MASS, D

from melt.reference._philox import ball_offset, random_words

C, L, T_B, ALWAYS = BOILING["specific_heat"], BOILING["latent_heat"], BOILING["boiling_point"], 2**30
R0 = BUBBLES["birth_radius"]
FIELDS = (
    "phase id position velocity mass rest_volume temperature latent_store bubble_volume bubble_radius birth_height age cargo"
).split()


def liquid(x, free=0, precision="double", **fields):
    """Liquid at x that is ready to boil, and free slots behind it with stale values."""
    x = np.asarray(x, float).reshape(-1, 3)
    n, m = len(x), len(x) + free
    given = dict(mass=np.full(m, MASS), rest_volume=np.full(m, D**3), temperature=np.full(m, T_B), latent_store=np.full(m, L))
    given.update({name: np.concatenate([np.asarray(v, float), np.full(np.shape(v)[:-1] + (free,), 7.0)], -1) for name, v in fields.items()})
    place = np.concatenate([x, np.full((free, 3), -3.0)])
    return pool(place, np.repeat([LIQUID, INACTIVE], [n, free]), precision, **given)


def boil(backend, a, step=0, room=None, first_id=1000, **changes):
    """Boil as the page does; return the slots of the particles served, by id."""
    moment = dict(step_low=step, step_high=0)
    run("boil_candidates", backend, a, threshold=changes.pop("threshold", ALWAYS), **moment, **changes)
    wanted = listed(backend, a, "candidate", 1, "birth")
    free = listed(backend, a, "phase", INACTIVE, "free", ordered=False)
    served = min(len(wanted), len(free) // 4, len(free) if room is None else room // 4)
    run("spawn_bubbles", backend, a, **moment, first_id=first_id, served=served, **changes)
    return wanted[:served]


@everywhere
@both
def test_candidates_by_hand(backend, precision):
    """At the boiling point, with the latent heat, liquid; a hair less is not enough, and NaN never is."""
    real = np.float32 if precision == "single" else np.float64
    under = np.nextafter(real(T_B), real(0)), np.nextafter(real(L), real(0))
    T = [T_B, T_B + 3, under[0], T_B, np.nan, T_B, T_B, np.inf]
    store = [L, 2 * L, 2 * L, under[1], L, L, np.nan, L]
    phase = [0, 0, 0, 0, 0, 3, 0, 0]
    a = pool(np.zeros((8, 3)), phase, precision, temperature=T, latent_store=store)
    run("boil_candidates", backend, a, threshold=ALWAYS, step_low=3, step_high=0)
    assert a["candidate"].tolist() == [1, 1, 0, 0, 0, 0, 0, 1]
    run("boil_candidates", backend, a, threshold=0, step_low=3, step_high=0)
    assert a["candidate"].tolist() == [0] * 8


@everywhere
@pytest.mark.parametrize("seed", [(12345, 0), (-1, -7), (0, -(2**31))])
@pytest.mark.parametrize("step", [(0, 0), (-5, 3)])
def test_draws_are_those_of_philox(backend, seed, step):
    """30 bits of the first word of counter (id, 0, step, 0), key (seed low, seed high ^ step high ^ 1): V2."""
    ids = np.random.default_rng(1).choice(2**31 - 1, 300, replace=False)
    a = pool(np.zeros((300, 3)), 0, id=ids, temperature=np.full(300, T_B), latent_store=np.full(300, L))
    threshold = 400_000_000
    seeds = dict(seed_low=seed[0], seed_high=seed[1])
    run("boil_candidates", backend, a, threshold=threshold, step_low=step[0], step_high=step[1], **seeds)
    words = [random_words(i, *step, 0, *seed, 1)[0] for i in ids]
    assert a["candidate"].tolist() == [int(w >> 2 < threshold) for w in words]
    assert 0 < a["candidate"].sum() < 300


@everywhere
def test_share_of_candidates_is_the_probability(backend):
    n, p = 20000, 0.2
    a = liquid(np.zeros((n, 3)))
    numbers = []
    for seed, step in ((1, 0), (1, 1), (2, 0)):
        run("boil_candidates", backend, a, threshold=int(p * 2**30), seed_low=seed, step_low=step, step_high=0)
        numbers.append(a["candidate"].copy())
        assert abs(numbers[-1].sum() - n * p) < 4 * np.sqrt(n * p * (1 - p))
    for other in numbers[1:]:  # independent: both boil with p^2
        assert abs((numbers[0] & other).sum() - n * p * p) < 4 * np.sqrt(n * p * p)


@everywhere
@both
def test_birth_by_hand(backend, precision):
    """Two of three boil, the smaller id first; the third finds no slots and stays as it is."""
    x = np.array([[0.1, 0.2, 0.3], [0.5, 0.4, 0.3], [0.2, 0.2, 0.2]])
    v = np.array([[0.3, -0.1, 0], [0.0, 0.2, 0], [0.1, 0.4, 0]])
    a = liquid(x, 11, precision, velocity=v, temperature=[101.0, T_B, T_B], latent_store=[L, 1.5 * L, L])
    a["id"][:3] = 20, 10, 30
    before = {name: value.copy() for name, value in a.items()}
    served = boil(backend, a, step=9)
    assert served.tolist() == [1, 0]
    assert a["phase"].tolist() == [5, 5, 0] + [3] * 8 + [5] * 3
    assert a["id"][3:11].tolist() == list(range(1000, 1008))
    rel = 3e-7 if precision == "single" else 1e-15
    for a_rank, parent in enumerate(served):
        for k in range(4):
            j = 3 + 4 * a_rank + k
            offset = ball_offset(1000 + 4 * a_rank + k, 9, 0, BOILING["seed_low"], BOILING["seed_high"], 0)
            assert a["position"][:, j] == pytest.approx(x[parent] + D * np.array(offset), rel=rel)
            assert (a["velocity"][:, j] == a["velocity"][:, parent]).all()
    on = slice(3, 11)
    V = 4 / 3 * np.pi * R0**3
    assert 4 * V == pytest.approx(D**3, rel=1e-15)  # no jump of density
    assert a["bubble_volume"][on] == pytest.approx(V, rel=rel) and a["bubble_radius"][on] == pytest.approx(R0, rel=rel)
    assert a["rest_volume"][on] == pytest.approx(V, rel=rel)
    assert (a["mass"][on] == 0).all() and (a["latent_store"][on] == 0).all() and (a["age"][on] == 0).all()
    assert (a["temperature"][on] == T_B).all() and (a["cargo"][on] == 1).all()
    assert (a["birth_height"][on] == a["position"][2, on]).all()
    assert (a["mass"][:2] == 0).all() and (a["rest_volume"][:2] == 0).all()
    excess = a["birth_excess"]
    assert excess.dtype == np.float64 and excess.sum() == pytest.approx(MASS * (0.5 * L + C), rel=1e-6)
    assert np.count_nonzero(excess) == 2
    for name in FIELDS:  # what was not served and what stayed free
        assert before[name][..., 2].tolist() == a[name][..., 2].tolist()
        assert before[name][..., 11:].tolist() == a[name][..., 11:].tolist()


@everywhere
def test_nucleate_keeps_the_parent_and_recycle_does_not(backend):
    a = liquid([[0.1, 0.2, 0.3]], 4, temperature=[T_B + 2], latent_store=[1.25 * L])
    boil(backend, a, mass_model=1, subcooling=6.0)
    assert a["phase"].tolist() == [0, 3, 3, 3, 3] and a["cargo"].tolist() == [0] * 5
    assert a["temperature"][0] == T_B - 4 and a["latent_store"][0] == 0
    assert a["mass"][0] == MASS and a["rest_volume"][0] == D**3
    assert a["birth_excess"].sum() == pytest.approx(MASS * (1.25 * L + 6 * C), rel=1e-14)
    a = liquid([[0.1, 0.2, 0.3]], 4)
    boil(backend, a, mass_model=2)
    assert a["phase"].tolist() == [5, 3, 3, 3, 3] and a["cargo"].tolist() == [0, 1, 1, 1, 1] and a["mass"][0] == 0


@everywhere
@both
def test_bubbles_are_born_within_the_walls(backend, precision):
    """A corner clamps; a gap narrower than a bubble puts it in the middle (6)."""
    a = liquid([[0.0, 0.5, 0.0]], 4, precision)
    boil(backend, a, lower_x=0.0, lower_z=0.0, lower_y=0.5 - 0.3 * D, upper_y=0.5 + 0.3 * D)
    x, y, z = a["position"][:, 1:].astype(float)
    assert (x >= R0 * (1 - 1e-6)).all() and (z >= R0 * (1 - 1e-6)).all()
    assert (x <= R0 * (1 + 1e-6)).any() and (z <= R0 * (1 + 1e-6)).any()
    assert y == pytest.approx(0.5, rel=1e-7)
    assert a["birth_height"][1:] == pytest.approx(z, rel=1e-7)


@everywhere
@both
def test_all_particles_boil_at_once(backend, precision):
    """500 of 500, with room for all: quarters of liquid exact, energy booked; with room for 123, these by id (6)."""
    n = 500
    rng = np.random.default_rng(2)
    x = rng.uniform(0.1, 0.4, (n, 3))
    a = liquid(x, 4 * n, precision, temperature=rng.uniform(T_B, 104, n), latent_store=rng.uniform(L, 2 * L, n))
    a["id"][:n] = rng.permutation(n)
    start = a["mass"][:n].astype(float) * (C * a["temperature"][:n] + a["latent_store"][:n])
    few = {name: value.copy() for name, value in a.items()}
    served = boil(backend, a)
    assert len(served) == n and (a["phase"] == LIQUID).sum() == 0 and (a["phase"] == BUBBLE).sum() == 4 * n
    assert a["cargo"][slots_of(a, BUBBLE)].sum() == 4 * n
    assert sorted(a["id"][slots_of(a, BUBBLE)]) == list(range(1000, 1000 + 4 * n))
    assert np.isfinite(a["position"]).all()
    content = float(a["mass"].dtype.type(MASS)) * n * (C * T_B + L) + a["birth_excess"].sum()
    assert content == pytest.approx(start.sum(), rel=1e-12 if precision == "double" else 1e-7)
    served = boil(backend, few, room=4 * 123 + 3)
    assert len(served) == 123 and few["id"][served].tolist() == list(range(123))
    assert (few["phase"][:n] == LIQUID).sum() == n - 123
    assert 4 * (n - 123) + few["cargo"][slots_of(few, BUBBLE)].sum() == 4 * n


@everywhere
def test_births_do_not_depend_on_slots_and_do_on_the_seed(backend):
    """Bitwise the same bubbles from the same seed wherever their parents are stored (V22)."""
    n = 60
    rng = np.random.default_rng(5)
    a = liquid(rng.uniform(0.1, 0.4, (n, 3)), 4 * n, velocity=rng.normal(size=(3, n)))
    pools = [a, shuffled(a, rng.permutation(5 * n)), {k: v.copy() for k, v in a.items()}, {k: v.copy() for k, v in a.items()}]
    for b, seed in zip(pools, (1, 1, 1, 2)):
        # ids of free slots would differ: only bubbles are compared
        boil(backend, b, threshold=ALWAYS // 2, seed_low=seed)
    kept = [{f: b[f][..., slots_of(b, BUBBLE)] for f in FIELDS} for b in pools]
    assert same_bits(kept[0], kept[1], FIELDS) and same_bits(kept[0], kept[2], FIELDS)
    assert len(kept[0]["id"]) > 0
    assert len(kept[3]["id"]) != len(kept[0]["id"]) or not same_bits(kept[0], kept[3], FIELDS)


@everywhere
def test_nothing_boils(backend):
    """No particles, no candidates, no room: nothing changes and no heat is booked."""
    for a in (liquid(np.zeros((0, 3))), liquid([[0.1, 0.2, 0.3]], 3), liquid([[0.1, 0.2, 0.3]], 4, temperature=[20.0])):
        a["birth_excess"][:] = 5
        before = {name: a[name].copy() for name in FIELDS}
        assert boil(backend, a).size == 0
        assert all((a[name] == before[name]).all() for name in FIELDS) and (a["birth_excess"] == 0).all()
