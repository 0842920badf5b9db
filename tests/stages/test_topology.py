"""Links, regions, components: the counts of the melting specification, and 1000 random bodies."""

import numpy as np
import pytest
from lattice_bodies import box, built, lattice

from melt.geometry.lattice import links
from melt.systems.topology import melt_and_relink

BACKENDS = ["reference", "cpu", "cuda"]


pytestmark = pytest.mark.usefixtures("emulated")


def melt(do, sites):
    do.heat(sites)
    melt_and_relink(do)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_counts_of_a_small_cube(backend):
    do = built(backend, box(3, 3, 3))
    n = do["site_link_count"]
    assert sorted(n.tolist()) == [8] * 8 + [12] * 12 + [18] * 6 + [27] and n[13] == 27
    melt(do, [0])
    counts = [
        0,
        11,
        8,
        11,
        17,
        12,
        8,
        12,
        8,
        11,
        17,
        12,
        17,
        26,
        18,
        12,
        18,
        12,
        8,
        12,
        8,
        12,
        18,
        12,
        8,
        12,
        8,
    ]
    assert do["site_link_count"].tolist() == counts


@pytest.mark.parametrize("backend", BACKENDS)
def test_b_filling_round_holes(backend):
    i, j = np.divmod(np.arange(20), 5)
    cell = np.stack([j, i, 0 * i])  # sites 1..20 of the specification, row by row

    def numbers(do, site):
        return [m + 1 for m in do.members(site - 1)]

    do = built(backend, cell)
    assert numbers(do, 17) == [6, 7, 8, 9, 11, 12, 13, 14, 16, 17, 18, 19]
    melt(do, [11])
    assert numbers(do, 17) == [6, 7, 8, 9, 11, 13, 14, 16, 17, 18, 19]
    melt(do, [10, 12])
    assert numbers(do, 17) == [14, 16, 17, 18, 19]
    melt(do, [15])
    assert numbers(do, 17) == [14, 17, 18, 19]
    narrow = built(backend, cell, lattice_params=lattice(width=1))
    for sites in ([11], [10, 12], [15]):
        melt(narrow, sites)
    assert numbers(narrow, 17) == [17, 18]


@pytest.mark.parametrize("backend", BACKENDS)
def test_c_a_chain_splits(backend):
    do = built(backend, [range(7), [0] * 7, [0] * 7])
    expected = [
        [0, 1, 2],
        [0, 1, 2, 3],
        [0, 1, 2, 3, 4],
        [1, 2, 3, 4, 5],
        [2, 3, 4, 5, 6],
        [3, 4, 5, 6],
        [4, 5, 6],
    ]
    assert [do.members(s) for s in range(7)] == expected
    melt(do, [3])
    assert [do.members(s) for s in range(7)] == [[0, 1, 2]] * 3 + [[]] + [[4, 5, 6]] * 3
    assert do["site_component"].tolist() == [0, 0, 0, -1, 4, 4, 4]


@pytest.mark.parametrize("backend", BACKENDS)
def test_d_hops_not_boxes(backend):
    do = built(backend, [[0, 0, 0, 1, 2, 2, 2], [0, 1, 2, 2, 2, 1, 0], [0] * 7])
    assert do.members(0) == [0, 1, 2, 3]


@pytest.mark.parametrize("backend", BACKENDS)
def test_bodies_in_adjacent_voxels_do_not_bond(backend):
    do = built(backend, box(4, 2, 2), np.repeat([0, 1], 8))
    assert do["site_component"].tolist() == [0] * 8 + [8] * 8
    assert do.members(7) == list(range(8)) and do.members(8) == list(range(8, 16))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("width", [0, 5])
def test_smallest_and_largest_regions(backend, width):
    do = built(backend, box(7, 2, 1), lattice_params=lattice(width=width))
    x = box(7, 2, 1)[0]
    for s in range(14):
        assert do.members(s) == np.flatnonzero(np.abs(x - x[s]) <= width).tolist() if width else [s]


def test_a_voxel_holds_one_site_of_a_body():
    cell = np.array([[0, 1, 1], [0, 0, 0], [0, 0, 0]])
    with pytest.raises(ValueError, match=r"sites 1 and 2 of body 0 share the voxel \(1, 0, 0\)"):
        links(cell, [0, 0, 0], [1, 1, 1])
    assert (links(cell, [0, 0, 1], [1, 1, 1])[2] >= 0).sum() == 1
    with pytest.raises(ValueError, match="connect = 8"):
        links(cell, [0, 0, 1], [1, 1, 1], connect=8)


def random_body(rng, size):
    """Return a ragged blob of cells, now and then in several pieces, and body numbers."""
    cell = box(size, size, max(1, size - 2))
    keep = rng.random(cell.shape[1]) < rng.uniform(0.15, 0.9)
    cell = cell[:, keep]
    return cell, (cell[0] >= size // 2) * int(rng.integers(0, 2))


def by_search(networkx, cell, body, alive, connect, w):
    """Return regions and components from a graph: hops counted by networkx."""
    graph = networkx.Graph()
    graph.add_nodes_from(np.flatnonzero(alive).tolist())
    d = np.abs(cell[:, :, None] - cell[:, None, :])
    bonded = (d.max(axis=0) <= 1) & (d.sum(axis=0) <= {6: 1, 18: 2, 26: 3}[connect])
    bonded &= (body[:, None] == body[None, :]) & alive[:, None] & alive[None, :]
    graph.add_edges_from((int(a), int(b)) for a, b in np.argwhere(np.triu(bonded, 1)))
    regions = {s: sorted(networkx.single_source_shortest_path_length(graph, s, cutoff=w)) for s in graph}
    labels = np.full(alive.size, -1)
    for piece in networkx.connected_components(graph):
        labels[list(piece)] = min(piece)
    return regions, labels


def test_refilling_equals_search_on_1000_random_bodies():
    """V17: after random melting, regions are those of a graph search, however they are refilled."""
    networkx = pytest.importorskip("networkx")
    rng = np.random.default_rng(17)
    for case in range(1000):
        connect, w = int(rng.choice([6, 18, 26])), int(rng.integers(0, 4))
        cell, body = random_body(rng, int(rng.integers(2, 6)))
        runs = [
            built("cpu", cell, body, lattice_params=lattice(width=w, connect=connect, refill=refill))
            for refill in (0, 1, 2)
        ]
        share = np.full(body.size, 1.0)
        for _ in range(2):
            hot = np.flatnonzero(rng.random(body.size) < 0.2)
            hot = hot[runs[0]["site_link_count"][hot] > 0]
            for do in runs:
                melt(do, hot)
        alive = runs[0]["site_link_count"] > 0
        regions, labels = by_search(networkx, cell, body, alive, connect, w)
        assert (runs[2]["site_component"] == labels).all(), case
        for s in range(body.size):
            assert runs[2].members(s) == regions.get(s, []), (case, s)
            assert runs[2]["site_region_count"][s] == len(regions.get(s, []))
        share = runs[0]["mass"][:1] if body.size else share
        for name in ("site_region", "site_region_count", "region_share", "region_mass", "region_rest"):
            for do in runs[:2]:
                assert np.array_equal(do[name], runs[2][name]), (case, name)
        for do in runs[2:]:
            do.region_match()
            do.goal()
            assert np.abs(do["goal"]).max(initial=0) <= 1e-12 * 0.2, case


@pytest.mark.parametrize("refill", [0, 1, 2])
@pytest.mark.parametrize("connect", [6, 26])
def test_backends_agree_on_random_bodies(refill, connect):
    rng = np.random.default_rng(5)
    for w in (0, 1, 2, 3):
        cell, body = random_body(rng, 6)
        hot = np.flatnonzero(rng.random(body.size) < 0.3)
        results = []
        for backend in BACKENDS:
            do = built(backend, cell, body, lattice_params=lattice(width=w, connect=connect, refill=refill))
            do.heat(hot)
            do.melt_test()
            do.melt_particles()
            do.mark_dirty()
            do.unlink()
            do.fill_regions()
            do.components()
            do.region_share()
            do.region_rest()
            results.append(do)
        names = (
            "melted",
            "site_melting",
            "phase",
            "site_dirty",
            "site_links",
            "site_link_count",
            "site_region",
            "site_region_count",
            "site_component",
        )
        for do in results[1:]:
            for name in names:
                assert np.array_equal(do[name], results[0][name]), (name, do.backend)
            for name in ("region_mass", "region_rest", "region_share"):
                assert do[name] == pytest.approx(results[0][name], rel=1e-13, abs=1e-14)
