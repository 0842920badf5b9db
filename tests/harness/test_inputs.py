"""The check inputs hold what can break a stage; checked by brute force, without the twins."""

import numpy as np
import pytest

from melt.check import _cloud, inputs
from melt.stages import STAGES

CLOUD, GRID = inputs.scene(301, 0, True, 2, 26)


def distances():
    x = CLOUD["position"]
    return np.sqrt(((x[:, :, None] - x[:, None, :]) ** 2).sum(axis=0))


def test_every_stage_of_the_registry_has_inputs_in_every_variant():
    for stage in STAGES:
        for choice in inputs.choices(stage):
            arrays, params, scales = inputs.make(stage, "single", 301, 0, choice)
            assert set(arrays) | set(params) == set(STAGES[stage].arguments)


def test_unknown_parameter_is_an_error_that_names_the_stage():
    stage = STAGES["density"]._replace(params=("smoothing", "viscosity_of_nobody"))
    with pytest.raises(inputs.UnknownInput, match="density.*viscosity_of_nobody"):
        inputs._params(stage, np.float32, GRID, {})


def test_all_phases_are_there_and_n_is_no_multiple_of_a_block():
    assert set(np.unique(CLOUD["phase"])) == {0, 1, 2, 5}
    assert 301 % 8 and inputs.scene(1003, 0, True, 2, 26)[0]["phase"].size % 128


def test_neighbour_lists_equal_brute_force():
    r, phase = distances(), CLOUD["phase"]
    near = (r < _cloud.SUPPORT) & ~np.eye(len(phase), dtype=bool)
    near[:, phase == 5] = False
    near[(phase == 5) | (phase == 2)] = False
    for i, row in enumerate(near):
        count = CLOUD["neighbour_count"][i]
        assert np.array_equal(CLOUD["neighbour_index"][i, :count], np.flatnonzero(row))


def test_extremes_are_there():
    r, phase = distances(), CLOUD["phase"]
    upper = np.triu(np.ones_like(r, dtype=bool), 1)
    active = (phase != 5)[:, None] & (phase != 5)[None, :] & upper
    assert (r[active] == 0).sum() >= 2, "coincident pairs"
    assert (r[active] == _cloud.SUPPORT).any(), "a pair exactly at the support"
    assert ((phase == 0) & (CLOUD["neighbour_count"] == 0)).any(), "an isolated liquid particle"
    assert np.abs(CLOUD["position"]).max() * GRID["inverse_cell"] > 2**31 - 1, "a cell index beyond int32"
    assert CLOUD["offenders"].max() >= 2, "one particle in two pairs that are too close"


def test_positions_are_exact_in_single_precision():
    single = CLOUD["position"].astype(np.float32)
    assert np.array_equal(single.astype(float), CLOUD["position"])


def test_particles_come_in_cell_order_with_the_inactive_last():
    assert np.all(np.diff(CLOUD["cell"]) >= 0)
    start, n = CLOUD["cell_start"], len(CLOUD["phase"])
    assert start[0] == 0 and start[-1] == n
    assert np.all(CLOUD["phase"][start[-2] :] == 5) and np.all(CLOUD["phase"][: start[-2]] != 5)


def test_bodies_have_inner_melted_vacant_and_spare_sites():
    count, particle, body = (CLOUD[k] for k in ("site_link_count", "site_particle", "site_body"))
    assert count.max() == 27 and (count == 1).any()
    assert ((count == 0) & (particle < 0) & (body >= 0)).any(), "a vacant site"
    assert ((CLOUD["phase"] == 0) & (CLOUD["site"] >= 0)).any(), "a liquid that remembers its site"
    assert (body < 0).any(), "spare sites"
    assert CLOUD["site_melting"].sum() > 0 and np.all(count[CLOUD["site_melting"] == 1] < 27)


def test_links_and_regions_are_symmetric():
    for table in ("site_links", "site_region"):
        rows = [set(row[row >= 0]) for row in CLOUD[table]]
        assert all(i in rows[j] for i, row in enumerate(rows) for j in row)


@pytest.mark.parametrize("precision", ["single", "double"])
def test_one_temperature_is_exactly_at_its_melting_point_and_one_just_below(precision):
    arrays, _, _ = inputs.make("melt_test", precision, 301)
    T, melts = arrays["temperature"], arrays["material_melting_point"][arrays["material"]]
    assert (T == melts).any()
    assert (np.nextafter(T, T.dtype.type(np.inf)) == melts).any()
