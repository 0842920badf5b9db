"""Every experiment can be started: its small version runs, has rows and claims nothing, or it is said here why none of it is run."""

import pathlib

import pytest

from experiments import load, names

#: Those whose small version takes at most 5 s once its stages are compiled.
QUICK = ["boiling-precision", "dam-break", "dam-break-impact", "dial", "melting-spin", "promises"]
#: Where the others' small versions are run, with more said of their rows.
ELSEWHERE = {
    "boiling-pbf-bench": "test_pbf_bench.py", "boiling-validation": "test_boiling_cases.py", "flood-analytic": "test_flood_cases.py",
    "flood-control": "test_flood_control_cases.py", "flood-measured": "test_flood_measured.py", "flood-table2": "test_flood_measured.py",
    "slime-analytic": "test_slime_cases.py", "slime-bench": "test_slime_bench.py", "slime-square": "test_slime_cases.py",
}
LONG = "over a minute on two busy cores, compiling included"
#: Not run here: why.
SLOW = {
    "atlas": "a sweep of a small map is run in tests/systems/test_atlas.py",
    "bench-scaling": "times stages: nothing but wall time",
    "boiling-table1": f"{LONG}: PBF and SPH of one tank",
    "boiling-tradeoff": f"{LONG}: a sweep, as in tests/systems/test_dial.py",
    "flood-table3": f"{LONG}: a flood and its picture",
    "flood-tradeoff": f"{LONG}: as boiling-tradeoff",
    "melting-fig7": "two minutes: all scenes, twice",
    "melting-heat": f"{LONG}: ten full cases; tests/validation/test_heat_cases.py has smaller ones",
    "melting-ledgers": f"{LONG}; tests/validation/test_mechanics.py has a smaller one",
    "melting-mechanics": f"{LONG}; tests/validation/test_mechanics.py has smaller ones",
    "melting-table2": "six minutes: full scenes",
    "scene-costs": LONG,
    "slime-bodies": f"{LONG}: a body for its whole time",
    "slime-coil": f"{LONG}; tests/systems/test_slime_splash.py runs a case of it",
    "slime-comparison": LONG,
    "slime-tradeoff": f"{LONG}: as boiling-tradeoff",
    "tradeoff-knobs": "three minutes: as boiling-tradeoff",
}


def test_every_experiment_is_started_or_said_not_to_be():
    assert sorted([*QUICK, *ELSEWHERE, *SLOW]) == names()
    for name, file in ELSEWHERE.items():
        text = (pathlib.Path(__file__).parent / file).read_text()
        assert name.replace("-", "_") in text and "quick=True" in text, name


@pytest.mark.parametrize("name", QUICK)
def test_small_version_has_rows_and_claims_nothing(name, tmp_path):
    experiment, path = load(name), tmp_path / f"{name}.h5"
    experiment.run(path, quick=True, say=lambda text: None)
    rows = experiment.report(path)
    assert rows and all(row.ok is None and row.bound == "" for row in rows)
