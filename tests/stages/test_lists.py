"""Lists of slots: by flag, and sorted by id (boiling 3)."""

import numpy as np
import pytest
from bubble_life_cases import BUBBLE, INACTIVE, UNSET, listed, pool, run
from liquid_cases import everywhere


@everywhere
def test_slots_of_a_phase_and_their_order(backend):
    a = pool(np.zeros((7, 3)), [3, 0, 5, 3, 1, 5, 3], id=[9, 4, 1, 2, 0, 7, 5])
    assert listed(backend, a, "phase", BUBBLE, "bubble", ordered=False).tolist() == [0, 3, 6]
    assert listed(backend, a, "phase", BUBBLE, "bubble").tolist() == [3, 6, 0]
    assert a["bubble_index"][3:].tolist() == [UNSET] * 4
    assert listed(backend, a, "phase", INACTIVE, "free", ordered=False).tolist() == [2, 5]
    assert listed(backend, a, "phase", 4, "burst").tolist() == [] and a["burst_count"].tolist() == [0]


@everywhere
@pytest.mark.parametrize("n", [0, 1, 255, 256, 257, 1003])
def test_lists_of_any_length(backend, n):
    rng = np.random.default_rng(n)
    phase = rng.choice([0, 3, 5], n)
    a = pool(np.zeros((n, 3)), phase, id=rng.permutation(n))
    for key in (0, 3, 5, 2):
        assert listed(backend, a, "phase", key, "bubble", ordered=False).tolist() == np.flatnonzero(phase == key).tolist()


@everywhere
@pytest.mark.parametrize("n, count", [(5000, 4999), (5000, 1025), (2049, 2048), (1024, 1024), (3, 2), (5, 0), (0, 0)])
def test_order_by_id_over_several_runs(backend, n, count):
    """Ids up to 2^31 - 1; entries behind the count stay as they are."""
    rng = np.random.default_rng(n + count)
    ids = rng.choice(2**31 - 1, n, replace=False) if n else np.zeros(0, int)
    a = pool(np.zeros((n, 3)), 0, id=ids)
    index = rng.permutation(n).astype(np.int32)
    a["birth_index"], a["birth_count"][0] = index.copy(), count
    run("order_by_id", backend, a, dict(index="birth_index", count="birth_count"))
    assert (np.diff(ids[a["birth_index"][:count]]) > 0).all()
    assert sorted(a["birth_index"][:count]) == sorted(index[:count])
    assert (a["birth_index"][count:] == index[count:]).all()
