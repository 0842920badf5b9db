"""Weights of the transfers: hand sums, orphans, rank, periodic boxes."""

import numpy as np
import pytest
from apic_cases import INACTIVE, W0, W1, WALL, case, periodic, run
from liquid_cases import everywhere, tolerance

from melt import params as P
from melt.physics.apic import pseudo_inverse

PRECISIONS = pytest.mark.parametrize("precision", ("single", "mixed", "double"))


@everywhere
@PRECISIONS
def test_two_nodes_and_a_wall(backend, precision):
    a, grid = case([[0, 0, 0], [0.2, 0, 0], [0, 0.1, 0]], [[0, 0, 0]], precision, phase=[0, 0, WALL])
    run("apic_weights", backend, a, grid)
    share = W1 / (W0 + W1)
    assert a["apic_weight"] == pytest.approx(W0 + W1, rel=tolerance(precision))
    assert a["apic_centre"].T == pytest.approx(np.array([[0.2 * share, 0, 0]]), rel=tolerance(precision), abs=1e-7)
    # D has one direction: 0.2^2 (1 - share) share along x, all else is dropped
    expected = [1 / (0.04 * share * (1 - share)), 0, 0, 0, 0, 0]
    assert a["apic_inverse"][:, 0] == pytest.approx(expected, rel=tolerance(precision), abs=1e-4)
    assert a["apic_state"].tolist() == [0]


@everywhere
@PRECISIONS
def test_orphans_lone_nodes_and_free_slots(backend, precision):
    # S = 2 (1 - q)^3 W0: 0.002 W0 at 0.45 m, 0.000432 W0 at 0.47 m
    x = [[0, 0, 0.45], [0, 0, -0.47], [5, 0, 0], [0.1, 0, 0], [0, 0, 0]]
    a, grid = case([[0, 0, 0]], x, precision, apic_phase=[0, 0, 0, 0, INACTIVE])
    run("apic_weights", backend, a, grid)
    back = np.argsort(a["apic_id"])
    assert a["apic_state"][back].tolist() == [0, 1, 1, 0, 0]
    assert a["apic_weight"][back][[1, 2, 4]].tolist() == [0, 0, 0]
    assert a["apic_weight"][back][0] == pytest.approx(0.002 * W0, rel=10 * tolerance(precision))
    centre = a["apic_centre"].T[back]
    assert centre == pytest.approx(np.array([[0, 0, -0.45], [0, 0, 0], [0, 0, 0], [-0.1, 0, 0], [0, 0, 0]]), rel=1e-6)
    assert np.abs(a["apic_inverse"]).max() == 0  # a lone node does not spread


@everywhere
@PRECISIONS
@pytest.mark.parametrize("edge", (0.5, 0.75, 1.0))
def test_pairs_through_the_sides_of_a_box(backend, precision, edge):
    """Nodes at all 27 images' side of a particle; two to four cells along an axis, or one."""
    rng = np.random.default_rng(3)
    cells = {0.5: (2, 3, 4), 0.75: (2, 2, 2), 1.0: (1, 1, 1)}[edge]
    box = np.array(cells) * edge
    nodes, apics = rng.uniform(0, 1, (40, 3)) * box, rng.uniform(0, 1, (30, 3)) * box
    period = periodic((0, 0, 0), cells, edge)
    a, grid = case(nodes, apics, precision, period, edge)
    run("apic_weights", backend, a, grid, **period)
    d = a["position"].T[:, None, :].astype(float) - a["apic_position"].T[None]
    d -= box * np.round(d / box)
    q = 2 * np.sqrt((d**2).sum(axis=2))
    W = W0 * np.where(q < 0.5, 6 * q**3 - 6 * q**2 + 1, 2 * np.maximum(1 - q, 0) ** 3)
    S = W.sum(axis=0)
    assert (a["apic_state"] == 0).all()
    assert a["apic_weight"] == pytest.approx(S, rel=10 * tolerance(precision))
    assert a["apic_centre"].T == pytest.approx((W[:, :, None] * d).sum(axis=0) / S[:, None], rel=1e-4, abs=1e-6)


def test_pseudo_inverse_against_numpy():
    """Well spread, flat, thin and lone: eigenvalues on both sides of the threshold, in any frame."""
    rng = np.random.default_rng(0)
    for size in (1.0, 1e-12):
        for values in ([0.08, 0.07, 0.05], [0.08, 0.05, 0.0021], [0.08, 0.05, 0.0009], [0.08, 1e-5, 0], [1e-4, 1e-5, 0], [0, 0, 0]):
            for real, tolerance_ in ((np.float64, 1e-12), (np.float32, 1e-4)):
                Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
                D = size * (Q * values) @ Q.T
                kept = np.array(values) >= 0.001
                expected = (Q[:, kept] / (size * np.array(values)[kept])) @ Q[:, kept].T
                six = pseudo_inverse(tuple(real(D[k]) for k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))), real(0.001 * size))
                got = np.array([[six[0], six[3], six[4]], [six[3], six[1], six[5]], [six[4], six[5], six[2]]], float)
                assert np.abs(got - expected).max() <= tolerance_ * max(np.abs(expected).max(), 1)


KERNELS = (P.CUBIC, 3, 1 / np.pi), (P.CUBIC, 2, 10 / (7 * np.pi)), (P.WENDLAND2, 3, 21 / (16 * np.pi))


@everywhere
@pytest.mark.parametrize("kernel, dimension, centre", KERNELS)
def test_any_kernel_and_the_plane(backend, kernel, dimension, centre):
    """W(0) = 8/(pi h^3), 40/(7 pi h^2) and 21/(2 pi h^3) with h = 2."""
    a, grid = case([[0, 0, 0]], [[0, 0, 0]], edge=2.0)
    run("apic_weights", backend, a, grid, support=2.0, kernel=kernel, dimension=dimension, orphan=1e-6)
    assert a["apic_weight"][0] == pytest.approx(centre, rel=1e-9)


@everywhere
@pytest.mark.parametrize("nodes, apics", ((0, 0), (0, 3), (3, 0)))
def test_nothing_is_fine(backend, nodes, apics):
    a, grid = case(np.zeros((nodes, 3)), np.zeros((apics, 3)))
    run("apic_weights", backend, a, grid)
    run("apic_to_nodes", backend, a, grid)
    run("nodes_to_apic", backend, a, grid, dt=0.1)
    run("elastic_force", backend, a, grid, dt=0.1)
    assert (a["apic_state"] == 1).all() and (a["node_state"] == 1).all()
    assert np.isfinite(a["velocity"]).all() and (a["force"] == 0).all()
