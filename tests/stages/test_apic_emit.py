"""APIC particles that enter with nodes."""

import numpy as np
import pytest
from apic_cases import case, run
from liquid_cases import everywhere


@everywhere
@pytest.mark.parametrize("precision", ("single", "mixed", "double"))
@pytest.mark.parametrize("elastic", (True, False))
def test_two_nodes_bring_two_particles_each(backend, precision, elastic):
    given = dict(
        inflow_position=[[0.0, 1, 2], [0, 0, 0], [3, 3, 3]], inflow_velocity=[[0, 0, 1], [0, 0, 0], [-1, -1, -2]], inflow_mass=[1, 2, 3],
        apic_offset=[[-0.25, 0.25], [0, 0], [0, 0.5]],
    )
    a, grid = case([], np.full((7, 3), 8.0), precision, apic_phase=5, apic_affine=6.0, **given)
    a["apic_strain"] = np.full((6, 7 if elastic else 0), 4, a["apic_mass"].dtype)
    run("emit_apic", backend, a, grid, first=1, count=2, slot=2, lag=0.5)
    assert a["apic_phase"].tolist() == [5, 5, 0, 0, 0, 0, 5]
    expected = [[0.75, 0, 2.5], [1.25, 0, 3], [2.25, 0, 2], [2.75, 0, 2.5]]
    assert a["apic_position"].T.tolist() == [[8, 8, 8]] * 2 + expected + [[8, 8, 8]]
    assert a["apic_velocity"].T.tolist() == [[0, 0, 0]] * 2 + [[0, 0, -1]] * 2 + [[1, 0, -2]] * 2 + [[0, 0, 0]]
    assert a["apic_mass"].tolist() == [1, 1, 1, 1, 1.5, 1.5, 1]
    assert a["apic_affine"].T.tolist() == [[6] * 9] * 2 + [[0] * 9] * 4 + [[6] * 9]
    if elastic:
        assert a["apic_strain"].T.tolist() == [[4] * 6] * 2 + [[1, 1, 1, 0, 0, 0]] * 4 + [[4] * 6]


@everywhere
def test_no_node_brings_none(backend):
    given = dict(inflow_position=np.zeros((3, 0)), inflow_velocity=np.zeros((3, 0)), inflow_mass=[], apic_offset=np.zeros((3, 8)))
    a, grid = case([], np.zeros((0, 3)), **given)
    run("emit_apic", backend, a, grid, first=0, count=0, slot=0, lag=0.0)
    assert a["apic_phase"].size == 0
