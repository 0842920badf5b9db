"""APIC particles of the check scene: in cell order, of every kind, exact in float32."""

import numpy as np
import pytest

from melt.check._cloud import INACTIVE, QUANTUM, cell_of
from melt.check._slime_apic import PERIODIC
from melt.check.inputs import choices, make, scene


@pytest.mark.parametrize("n, choice", ((301, {}), (157, {}), (157, PERIODIC), (1, {}), (0, {})))
def test_particles_come_in_cell_order_with_the_inactive_last(n, choice):
    a, _, _ = make("apic_weights", "double", n, choice=choice)
    start = make("apic_to_nodes", "double", n, choice=choice)[0]["apic_start"]
    _, grid = scene(n, 0, True, 2, 26)
    cell = cell_of(a["apic_position"].T, a["apic_phase"], grid)
    assert (np.diff(cell) >= 0).all() and (cell[a["apic_phase"] == INACTIVE] == grid["nx"] * grid["ny"] * grid["nz"]).all()
    assert (start == np.searchsorted(cell, np.arange(len(start)))).all()
    assert (np.mod(a["apic_position"], QUANTUM) == 0).all()


@pytest.mark.parametrize("choice", ({}, PERIODIC))
def test_every_kind_is_there(choice):
    a, params, _ = make("nodes_to_apic", "double", 157, choice=choice)
    state = make("apic_sums", "double", 157)[0]["apic_state"]
    active, near = a["apic_phase"] == 0, a["apic_weight"] > 0
    assert (~active).sum() > 5 and not (near & ~active).any() and (state[active] == 1).sum() > 5
    if choice:
        assert params["period"].length_x > 0
    else:
        assert (active & ~near).sum() > 5
    flat = near & (np.abs(a["apic_inverse"]).max(axis=0) == 0)
    assert flat.any() or choice  # a lone node near, which does not spread


def test_the_box_and_the_plane_are_among_the_variants():
    assert all(c in choices("apic_to_nodes") for c in (PERIODIC, {"dimension": 2}))
