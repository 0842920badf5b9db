"""Merging of bubbles (boiling 2.5, 3; V17, V18)."""

import numpy as np
import pytest
from bubble_cases import BUBBLES, INERTIA
from bubble_life_cases import (
    BUBBLE,
    CELL,
    GRID,
    INACTIVE,
    bubbles,
    listed,
    merge,
    pool,
    run,
    same_bits,
    shuffled,
    slots_of,
)
from liquid_cases import both, everywhere
from pbf_cases import D
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

R0 = BUBBLES["birth_radius"]
AGE = BUBBLES["merge_age"]
STATE = "phase id position velocity rest_volume bubble_volume bubble_radius birth_height age cargo".split()
#: Exact in single precision, so that bubbles touch to the last bit.
Q = 2.0**-6


def volume(a):
    return a["bubble_volume"].sum()


def momentum(a):
    return INERTIA * (a["bubble_volume"] * a["velocity"].astype(float)).sum(axis=1)


def cloud(n, seed, precision="double", spread=1.0, **fields):
    """Bubbles of several radii, about one neighbour each, with shuffled ids and a velocity."""
    rng = np.random.default_rng(seed)
    r = rng.choice([0.5, 1.0, 1.5, 3.0], n) * R0
    side = 3.2 * R0 * n ** (1 / 3) * spread
    given = dict(id=rng.permutation(n) * 3 + 7, velocity=rng.normal(size=(3, n)), cargo=rng.integers(1, 9, n), **fields)
    return bubbles(rng.uniform(0, side, (n, 3)) + 0.02, r, precision, **given)


@everywhere
@both
def test_two_by_hand(backend, precision):
    """V0, momentum and centre of mass of two unequal bubbles; the smaller id keeps its slot, the other is freed."""
    r = np.array([Q, 2 * Q])
    v = np.array([[0.5, -0.25], [0.0, 0.5], [0.25, 1.0]])
    a = bubbles([[8 * Q, 4 * Q, 6 * Q], [10 * Q, 4 * Q, 6 * Q]], r, precision, velocity=v, id=[9, 4], cargo=[1, 3], age=[0.5, 0.1])
    V = a["bubble_volume"].copy()
    assert V[1] == pytest.approx(8 * V[0], rel=1e-15)
    merge(backend, a, floor=Q)
    assert a["merge_root"].tolist() == [1, 1] and a["merge_size"].tolist() == [0, 2]
    assert a["phase"].tolist() == [INACTIVE, BUBBLE] and a["id"].tolist() == [9, 4]
    rel = 2e-7 if precision == "single" else 1e-15
    assert a["bubble_volume"].tolist() == [0, V[0] + V[1]]
    assert a["bubble_radius"] == pytest.approx([0, 9 ** (1 / 3) * Q], rel=rel)
    assert a["position"][:, 1] == pytest.approx([(8 + 80) / 9 * Q, 4 * Q, 6 * Q], rel=rel)
    assert a["velocity"][:, 1] == pytest.approx([(0.5 - 2) / 9, 4 / 9, 8.25 / 9], rel=rel)
    assert a["cargo"].tolist() == [0, 4]
    assert a["rest_volume"] == pytest.approx([0, min(9 * V[0], 4.2 * D**3)], rel=rel)
    assert a["birth_height"][1] == pytest.approx(5 * Q, rel=rel)
    assert a["age"][1] == pytest.approx(AGE, rel=1e-6)
    assert (a["merge_removed"] == 0).all()


@everywhere
@both
def test_literal_place_and_direction(backend, precision):
    """``plain_mean``: the mean of the places; ``upward``: the horizontal momentum is taken out and booked."""
    v = np.array([[0.5, -0.25, 9], [0.0, 0.5, 9], [0.25, 1.0, 9]])
    a = bubbles([[8 * Q, 4 * Q, 6 * Q], [10 * Q, 4 * Q, 6 * Q], [60 * Q] * 3], [Q, 2 * Q, Q], precision, velocity=v, id=[9, 4, 5])
    before = momentum(a)
    merge(backend, a, plain_mean=1, upward=1)
    assert a["position"][:, 1].tolist() == [9 * Q, 4 * Q, 6 * Q]
    V, w = 4 / 3 * np.pi * Q**3, 8.25 / 9
    assert a["velocity"][:, 1] == pytest.approx([0, 0, w], rel=2e-7)
    inertia = float(np.float32(INERTIA)) if precision == "single" else INERTIA
    expected = inertia * V * np.array([0.5 - 8 * 0.25, 8 * 0.5, 0])
    assert a["merge_removed"].sum(axis=1) == pytest.approx(expected, rel=1e-14)
    if precision == "double":
        assert momentum(a) + a["merge_removed"].sum(axis=1) == pytest.approx(before, rel=1e-14)
    assert a["velocity"][:, 2].tolist() == [9, 9, 9]  # a bubble on its own keeps its direction


@everywhere
@both
def test_touching_is_merging_and_a_hair_less_is_not(backend, precision):
    """Distance r_a + r_b to the last bit; then a unit in the last place further."""
    real = np.float32 if precision == "single" else np.float64
    for apart, number in ((3 * Q, 1), (float(np.nextafter(real(3 * Q), real(1))), 2)):
        a = bubbles([[0, 0, 0], [0, 0, apart]], [Q, 2 * Q], precision)
        merge(backend, a)
        assert slots_of(a, BUBBLE).size == number


@everywhere
def test_the_young_stay_apart(backend):
    """Siblings overlap at birth: both must have reached t_imm, and a young one is no bridge either."""
    x = [[k * 1.5 * R0, 0.1, 0.1] for k in range(5)]
    a = bubbles(x, R0, age=[0.2, 0.2, 0.0999, AGE, AGE])
    merge(backend, a)
    assert a["merge_root"].tolist() == [0, 0, 2, 3, 3] and a["merge_size"].tolist() == [2, 0, 1, 2, 0]
    assert slots_of(a, BUBBLE).tolist() == [0, 2, 3]


@everywhere
@both
@pytest.mark.parametrize("n", [2, 3, 1000])
@pytest.mark.parametrize("shape", ["chain", "heap"])
def test_all_become_one_whatever_their_slots(backend, precision, n, shape):
    """V17: V0 and momentum to 1e-13 (float32 velocity 1e-6), and the same bits for any order of the slots."""
    rng = np.random.default_rng(n)
    if shape == "chain":  # a helix, ids shuffled along it
        turn = np.arange(n) * 0.03
        x = np.column_stack([0.2 + 0.1 * np.cos(turn), 0.2 + 0.1 * np.sin(turn), 1.2 * R0 * np.arange(n) / 6])
        x[:, 2] += 0.01
        r = np.full(n, R0)
    else:
        x, r = rng.uniform(0.2, 0.2 + R0, (n, 3)), R0 * rng.uniform(1, 2, n)
    a = bubbles(x, r, precision, id=rng.permutation(n) + 5, velocity=rng.normal(size=(3, n)), cargo=rng.integers(0, 5, n))
    V, p, quarters = volume(a), momentum(a), a["cargo"].sum()
    scale = INERTIA * (a["bubble_volume"] * np.abs(a["velocity"])).sum()
    other = shuffled(a, rng.permutation(n))
    for pool_ in (a, other):
        merge(backend, pool_)
        assert slots_of(pool_, BUBBLE).size == 1 and pool_["merge_size"].max() == n
    assert volume(a) == pytest.approx(V, rel=1e-13)
    assert np.abs(momentum(a) - p).max() <= (1e-13 if precision == "double" else 1e-6) * scale
    assert a["cargo"].sum() == quarters
    assert a["id"][slots_of(a, BUBBLE)] == a["id"].min()
    assert same_bits(a, other, STATE)


@everywhere
@both
def test_components_are_those_of_scipy(backend, precision):
    """1 000 bubbles of unlike size in a cloud: pairs from a tree, components from SciPy, the same bits when shuffled."""
    a = cloud(1000, 4, precision)
    a["age"][::9] = 0
    x, r, ids = a["position"].T.astype(float), a["bubble_radius"].astype(float), a["id"]
    i, j = cKDTree(x).query_pairs(2.001 * r.max(), output_type="ndarray").T
    on = (np.linalg.norm(x[i] - x[j], axis=1) <= r[i] + r[j]) & (a["age"][i] > 0) & (a["age"][j] > 0)
    labels = connected_components(coo_array((np.ones(on.sum()), (i[on], j[on])), shape=(1000, 1000)), directed=False)[1]
    root, size = np.empty(1000, int), np.zeros(1000, int)
    for label in range(labels.max() + 1):
        members = np.flatnonzero(labels == label)
        first = members[np.argmin(ids[members])]
        root[members], size[first] = first, len(members)
    assert 3 < (size > 1).sum() and size.max() > 5 and (size == 1).sum() > 50
    other = shuffled(a, np.random.default_rng(8).permutation(1000))
    merge(backend, a)
    assert (a["merge_root"] == root).all() and (a["merge_size"] == size).all()
    merge(backend, other)
    assert same_bits(a, other, STATE)


@everywhere
@both
def test_cascade_conserves_cargo_and_volume(backend, precision):
    """V18: rounds of drifting together until few are left; cargo exact, volume to 1e-13 without growth."""
    n = 400
    a = cloud(n, 6, precision, spread=1.3)
    V, quarters = volume(a), int(a["cargo"].sum())
    counts = [n]
    for _ in range(8):
        alive = slots_of(a, BUBBLE)
        middle = a["position"][:, alive].mean(axis=1, keepdims=True)
        a["position"] = (middle + (a["position"] - middle) * 0.9).astype(a["position"].dtype)
        a["age"][alive] = 1
        merge(backend, a)
        counts.append(slots_of(a, BUBBLE).size)
        assert a["cargo"].sum() == quarters == a["cargo"][slots_of(a, BUBBLE)].sum()
        assert volume(a) == pytest.approx(V, rel=1e-13)
    assert counts[1] < n and counts[-1] < n // 10 and sorted(counts, reverse=True) == counts


@everywhere
@both
def test_grown_bubbles_merge_with_their_volume_of_now(backend, precision):
    """The change of volume is the growth of those that merge, and nothing else."""
    growth = np.array([1.25, 1.0, 1.125, 1.0])
    a = bubbles([[0.1, 0.1, 0.1], [0.1, 0.1, 0.1 + R0], [0.1, 0.1, 0.1 - R0], [0.4, 0.1, 0.1]], R0, precision)
    V = a["bubble_volume"][0]
    a["bubble_radius"] *= growth.astype(a["mass"].dtype)
    merge(backend, a)
    rel = 1e-6 if precision == "single" else 1e-14
    assert a["bubble_volume"] == pytest.approx([V * (1.25**3 + 1 + 1.125**3), 0, 0, V], rel=rel)
    assert a["bubble_radius"][0] == pytest.approx(R0 * (1.25**3 + 1 + 1.125**3) ** (1 / 3), rel=rel)


def volume_now(a):
    """Volume of the bubbles by their radii."""
    return 4 / 3 * np.pi * (a["bubble_radius"][slots_of(a, BUBBLE)].astype(float) ** 3).sum()


@everywhere
@both
def test_ten_seconds_of_rising_growing_and_merging(backend, precision):
    """V18: every change of the volume comes from growth, none from merging; cargo is exact."""
    n, dt = 150, 0.25
    rng = np.random.default_rng(12)
    x = np.column_stack([rng.uniform(0.05, 0.2, (n, 2)), rng.uniform(0.01, 0.05, n)])
    a = bubbles(x, R0 * rng.uniform(0.6, 1.0, n), precision, id=rng.permutation(n), birth_height=x[:, 2], age=np.zeros(n))
    quarters, grown, counts = int(a["cargo"].sum()), 0.0, [n]
    first = volume_now(a)
    rel = 1e-13 if precision == "double" else 1e-6
    listed(backend, a, "phase", BUBBLE, "bubble")
    for _ in range(40):
        alive = slots_of(a, BUBBLE)
        a["position"][2, alive] += (rng.uniform(0, 0.02, n)[: alive.size] * dt).astype(a["position"].dtype)
        before = volume_now(a)
        run("bubble_growth", backend, a, dt=dt)
        after = volume_now(a)
        assert after >= before * (1 - rel)
        grown += after - before
        merge(backend, a)
        assert volume_now(a) == pytest.approx(after, rel=rel)
        listed(backend, a, "phase", BUBBLE, "bubble")
        counts.append(slots_of(a, BUBBLE).size)
        assert a["cargo"].sum() == quarters == a["cargo"][slots_of(a, BUBBLE)].sum()
    assert volume_now(a) - first == pytest.approx(grown, rel=1e-10 if precision == "double" else 1e-3)
    assert grown > 0.02 * first and counts[-1] < n // 2


@everywhere
@both
def test_a_bubble_larger_than_the_grid(backend, precision):
    """r > R, r > tank: the coarse cells become one, the displaced volume is capped, nothing is lost (6)."""
    a = bubbles([[0.1, 0.1, 0.1], [1.4, 0.1, 0.1], [0.2, 3.0, 0.1]], [2.0, 0.01, 0.01], precision, id=[8, 3, 5])
    V = volume(a)
    coarse = int(np.ceil(2.001 * 2.0 / CELL))
    assert coarse > max(GRID["nx"], GRID["ny"], GRID["nz"])
    merge(backend, a)
    assert set(a["bubble_cell"]) == {0}
    assert slots_of(a, BUBBLE).tolist() == [1, 2] and volume(a) == pytest.approx(V, rel=1e-14)
    assert a["rest_volume"][1] == pytest.approx(4.2 * D**3, rel=1e-6)
    assert np.isfinite(a["position"]).all() and a["id"][1] == 3


@everywhere
def test_coarse_cells_by_hand(backend):
    """Blocks of 3 cells: 3 along x and y, the last one cut; others than bubbles stand behind the last cell."""
    x = (np.array([[0.5, 0.5, 0.5], [2.5, 0.5, 0.5], [3.5, 6.5, 8.5], [-9, 99, 3.5], [0.5, 0.5, 0.5], [np.nan, 0.5, 0.5]])) * CELL
    a = pool(x, [3, 3, 3, 3, 0, 3])
    run("bubble_cell", backend, a, coarse=3)
    assert a["bubble_cell"].tolist() == [0, 0, 1 + 3 * (2 + 3 * 2), 0 + 3 * (2 + 3 * 1), 8 * 7 * 9, 0]
    run("bubble_cell", backend, a, coarse=1)
    assert a["bubble_cell"].tolist() == [0, 2, 3 + 8 * (6 + 7 * 8), 0 + 8 * (6 + 7 * 3), 8 * 7 * 9, 0]


@everywhere
def test_no_bubbles(backend):
    """An empty pool, and one of liquid: labels say so, nothing changes."""
    for a in (pool(np.zeros((0, 3)), 0), pool(np.full((5, 3), 0.1), [0, 5, 2, 0, 4])):
        a["merge_removed"][:] = 5
        before = {name: a[name].copy() for name in STATE}
        merge(backend, a, upward=1)
        assert (a["merge_root"] == -1).all() and (a["merge_size"] == 0).all() and (a["merge_removed"] == 0).all()
        assert all((a[name] == before[name]).all() for name in STATE)


@everywhere
def test_a_merged_bubble_waits_for_the_next_step(backend):
    """What the new bubble reaches is left to the next round."""
    a = bubbles([[0.2, 0.2, 0.2], [0.2, 0.2, 0.2], [0.2 + 2.2 * R0, 0.2, 0.2]], R0)
    merge(backend, a)
    assert slots_of(a, BUBBLE).tolist() == [0, 2]
    assert listed(backend, a, "phase", BUBBLE, "bubble").tolist() == [0, 2]
    merge(backend, a)
    assert slots_of(a, BUBBLE).tolist() == [0] and a["cargo"].tolist() == [3, 0, 0]
