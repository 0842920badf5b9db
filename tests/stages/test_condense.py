"""Condensate: released liquid that returns to the surface (boiling 3, mass_model = recycle)."""

import numpy as np
import pytest
from bubble_cases import BOILING, BUBBLES
from bubble_life_cases import GRID, INACTIVE, LIQUID, listed, pool
from liquid_cases import both, everywhere
from pbf_cases import MASS, D, pbf_tuple

from melt import params as P
from melt.check.compare import run_stage
from melt.physics.bubble_life import column_of
from melt.reference._philox import random_words
from melt.stages import STAGES

BOX = dict(lower_x=D / 2, lower_y=D, width_x=12 * D, width_y=10 * D, mass=MASS, volume=D**3, temperature=20.0)
FIELDS = STAGES["condense"].writes


def tank(backend, free, precision="double", x=((0.1, 0.1, 0.07),)):
    """Some liquid, bubbles' old slots behind it with stale values, both listed."""
    x = np.asarray(x, float).reshape(-1, 3)
    n, m = len(x), len(x) + free
    stale = {name: np.full(m, 7.0) for name in ("mass", "rest_volume", "temperature", "latent_store", "bubble_radius", "age")}
    stale |= {name: np.full(m, 7) for name in ("cargo", "iterations")}
    stale |= {name: np.full(m, 0.25) for name in ("effect_precision", "support_radius")}
    place = np.concatenate([x, np.full((free, 3), -3.0)])
    a = pool(place, np.repeat([LIQUID, INACTIVE], [n, free]), precision, velocity=np.full((3, m), 7.0), **stale)
    listed(backend, a, "phase", INACTIVE, "free", ordered=False)
    return a


def condense(backend, a, served, step=9, first_id=1000, uniform=1, floor=0.0, **changes):
    """Run the stages of the page; return the slots that were filled."""
    real = a["mass"].dtype.type
    params = dict(
        grid=P.make(P.Grid, real, **GRID),
        bubbles=P.make(P.Bubbles, real, **{**BUBBLES, "floor": floor}),
        boiling=P.make(P.Boiling, real, **{**BOILING, **{k: v for k, v in changes.items() if k in BOILING}}),
        pbf=pbf_tuple(real=real, uniform=uniform),
        condensate=P.make(P.Condensate, real, **{**BOX, **{k: v for k, v in changes.items() if k in BOX}}),
        **{k: np.int32(v) for k, v in dict(step_low=step, step_high=0, first_id=first_id, served=served).items()},
    )
    for stage in ("surface_column", "condense"):
        need = STAGES[stage]
        out = run_stage(stage, backend, {n: a[n] for n in need.arguments if n in a}, {n: params[n] for n in need.params})
        a.update(out)
    return a["free_index"][:served]


@everywhere
@both
def test_it_lies_on_the_surface_cold_and_at_rest(backend, precision):
    """A spacing above the highest particle of its column: half to the surface, half to its own centre."""
    xy = [(i * D + D / 2, j * D + D / 2) for i in range(13) for j in range(11)]
    x = np.array([(a, b, z) for a, b in xy for z in (D / 2, 3 * D / 2)])
    a = tank(backend, 40, precision, x)
    before = {name: a[name].copy() for name in FIELDS}
    new = condense(backend, a, 30)
    assert (a["phase"][new] == LIQUID).all() and a["id"][new].tolist() == list(range(1000, 1030))
    rel = 1e-6 if precision == "single" else 1e-12
    assert a["position"][2, new] == pytest.approx(np.full(30, 2.5 * D), rel=1e-4)  # heights are told in steps of 1/4096 spacing
    for axis, low, width in ((0, D / 2, 12 * D), (1, D, 10 * D)):
        assert (a["position"][axis, new] >= low * (1 - rel)).all() and (a["position"][axis, new] <= (low + width) * (1 + rel)).all()
        assert np.ptp(a["position"][axis, new]) > 0.6 * width
    real = a["mass"].dtype.type
    for name, value in (("mass", MASS), ("rest_volume", D**3), ("temperature", 20)):
        assert (a[name][new] == real(value)).all(), name
    for name in ("velocity", "latent_store", "bubble_radius", "age", "cargo"):
        assert (a[name][..., new] == 0).all(), name
    for name in FIELDS:
        assert (np.delete(a[name], new, axis=-1) == np.delete(before[name], new, axis=-1)).all(), name
    assert (a["iterations"] == before["iterations"]).all() and (a["support_radius"] == before["support_radius"]).all()


@everywhere
def test_places_are_those_of_the_generator(backend):
    """Stream 2 by id, 24 bits a coordinate; another step, seed or id gives another place."""
    a = tank(backend, 3)
    new = condense(backend, a, 2, first_id=123456)
    for slot, id in zip(new, (123456, 123457)):
        u, v = (w >> 8 for w in random_words(id, 9, 0, 0, BOILING["seed_low"], BOILING["seed_high"], 2)[:2])
        assert a["position"][:2, slot] == pytest.approx([D / 2 + 12 * D * u / 2**24, D + 10 * D * v / 2**24], rel=1e-14)
    for other in (dict(step=10), dict(seed_low=2), dict(first_id=77)):
        b = tank(backend, 3)
        where = condense(backend, b, 2, **{"first_id": 123456, **other})
        assert (b["position"][:2, where] != a["position"][:2, new]).all()


@everywhere
@both
def test_effect_precision_starts_as_at_the_surface(backend, precision):
    a = tank(backend, 2, precision)
    new = condense(backend, a, 1, uniform=0)
    assert a["effect_precision"][new] == 1 and a["iterations"][new] == 4
    assert a["support_radius"][new] == a["mass"].dtype.type(2.2 * D)
    assert a["iterations"].tolist() == [7, 4, 7]


@everywhere
def test_an_empty_column_is_filled_from_its_floor_and_nothing_from_nothing(backend):
    a = tank(backend, 8, x=[(0.4, 0.35, 0.07)])
    full = int(column_of(0.4, 0.35, P.make(P.Grid, np.float64, **GRID)))
    new = condense(backend, a, 8, floor=-0.1)
    columns = [int(column_of(*a["position"][:2, i], P.make(P.Grid, np.float64, **GRID))) for i in new]
    assert full not in columns
    assert a["position"][2, new] == pytest.approx(np.full(8, -0.1 + D / 2), rel=1e-12)
    a = tank(backend, 3)
    before = {name: a[name].copy() for name in FIELDS}
    condense(backend, a, 0)
    assert all((a[name] == before[name]).all() for name in FIELDS)
    condense(backend, tank(backend, 2, x=np.zeros((0, 3))), 2)  # a dry tank
