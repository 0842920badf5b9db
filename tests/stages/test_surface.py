"""Free surface test on a lattice."""

import numpy as np
from liquid_cases import DX, both, box, everywhere, particles, run


def flags(backend, a):
    return run("surface", backend, a, full_neighbours=80.0)["surface"]


@everywhere
@both
def test_the_outer_layer_of_a_block(backend, precision):
    x = box(7, 7, 7)
    a = particles(x, 0, precision)
    layer = np.round(np.sort(np.minimum(x, 7 * DX - x), axis=1) / DX - 0.5).astype(int)
    found = flags(backend, a)
    assert found[layer[:, 0] == 0].all()  # faces, edges, corners
    assert not found[(layer[:, 0] == 1) & (layer[:, 1] > 1)].any()  # second layer away from edges
    assert not found[layer[:, 0] > 1].any()


@everywhere
@both
def test_liquid_beside_walls_and_solids_is_not_on_the_surface(backend, precision):
    x = box(7, 7, 7)
    phase = np.where(x[:, 0] < 2.1 * DX, 2, np.where(x[:, 0] > 4.9 * DX, 1, 0))
    found = flags(backend, particles(x, phase, precision))
    middle = (np.abs(x[:, 1:] - 3.5 * DX) < 1.1 * DX).all(axis=1)
    assert found[middle & (phase == 0)].sum() == 0  # nor is what touches a body
    assert found[phase == 2].sum() == 0
    assert found[(phase == 1) & (x[:, 0] > 6 * DX)].all()  # a dry face of a solid is
    assert found[(phase == 0) & (x[:, 2] < DX)].all()


@everywhere
@both
def test_isolated_coincident_and_empty(backend, precision):
    assert flags(backend, particles([[0, 0, 0]], 0, precision))[0] == 1
    assert flags(backend, particles([[0, 0, 0], [0, 0, 0]], 0, precision)).tolist() == [1, 1]
    assert flags(backend, particles(np.zeros((0, 3)), 0, precision)).size == 0
