"""The watchdog: each system driven into the ground is stopped in words with the call to blame, or saved by halved steps."""

import re

import numpy as np
import pytest
from boiling_scenes import tank
from extreme_scenes import scene
from flood_scenes import flood
from scene_runs import datasets
from slime_scenes import pool

from melt import simulation
from melt.cpu import pressure
from melt.errors import MeltError, Unstable
from melt.output.errors import OutputError
from melt.output.run_reader import open_run
from melt.simulation import Simulation
from melt.watch import capsule
from melt.watch.hunt import Watched

DFSPH = {"pressure": "dfsph", "apic": None, "ghosts": None}
#: Scenes that burst as they are, and what is said of it; halved steps save each.
UNSTABLE = {
    "melting": (
        lambda: scene(time={"n_sub": 1, "dt": 0.06, "end": 0.6, "output_every": 0.12}),
        r"the largest speed is .* beyond the alarm of .* Stage kick .* the bound 'sound' allows ",
    ),
    "boiling": (
        lambda: tank(
            (5, 5), 30, head=6, boiling={"latent_scale": 1.0, "heater": None}, fluid={"temperature": 20},
            solver={"pressure": "pbf", "precision": "double", "pbf": {"iterations": 1}},
            time={"n_sub": 1, "dt": 1 / 30, "end": 1.0, "output_every": 1 / 6},
        ),
        r"the liquid is compressed by .* on average, beyond the alarm of 50.0% .* Most compressed, by .*, is particle .* stage pbf_lambda ",
    ),
    "flood": (
        lambda: flood(solver={"viscosity": 200.0}, time={"dt": 0.2, "end": 0.2, "output_every": 0.2, "n_sub_max": 30}),
        r"the bound .force. allows sub-steps of .* but time.n_sub_max is 30.* stage flood_bounds ",
    ),
    "slime": (
        lambda: pool(
            fluid={"jitter": 0.0}, solver=DFSPH | {"dfsph": {"max_iterations": 12, "retries": 0}},
            time={"dt": 0.02, "end": 0.2, "output_every": 0.1},
        ),
        r"has not converged \(density solve after 12 iterations.* stage pressure_update .*\('gravity' governs",
    ),
}  # fmt: skip


class Heard:
    """What a run says."""

    def __init__(self):
        self.words, self.sim = [], None

    def __call__(self, event, message="", simulation=None, **_):
        self.sim = simulation or self.sim
        if event == "unstable":
            self.words.append(message)


@pytest.mark.parametrize("system", UNSTABLE)
def test_a_run_that_bursts_stops_with_its_bound_its_stage_and_a_capsule(system, tmp_path):
    given, said = UNSTABLE[system]
    path = tmp_path / "run.vtkhdf"
    with pytest.raises(Unstable, match=said) as caught:
        simulation.run(given(), path, backend="cpu")
    text = str(caught.value)
    assert "\n" not in text
    found = capsule.read(capsule.beside(path))
    assert found.stage in text and f"melt check --capsule {capsule.beside(path)}" in text
    with open_run(path) as run:
        assert len(run) >= 1 and all(np.isfinite(run.frame(-1)[name]).all() for name in ("position", "velocity"))


@pytest.mark.parametrize("system", UNSTABLE)
def test_halved_steps_save_it_and_the_file_says_so(system, tmp_path):
    given, heard, path = UNSTABLE[system][0](), Heard(), tmp_path / "run.vtkhdf"
    done = simulation.run(given, path, backend="cpu", progress=heard, on_unstable="halve")
    steps, every = given.time.steps, given.time.output_steps
    times = [given.time.dt * k for k in range(0, steps + 1, every)]
    with open_run(path) as run:
        assert run.times == pytest.approx(times, rel=1e-12)  # frames come when they would
        halvings, dt = run.series["halvings"], run.series["dt"]
        assert halvings.max() >= 1 and run.series["alarms"][-1] == len(heard.words) >= 1
        assert np.array_equal(dt, given.time.dt / 2.0**halvings)
        assert run.provenance["alarms"].splitlines() == done.simulation.do.clock.alarms
        assert all(np.isfinite(run.frame(-1)[name]).all() for name in ("position", "velocity"))
    assert all(re.search(r"Back to t = .* on with steps of \S+ s$", words) for words in heard.words)
    assert done.simulation.do.clock.step == steps


def test_what_halved_steps_do_not_save_is_stopped_after_as_many_as_allowed(tmp_path):
    given, path = UNSTABLE["melting"][0](), tmp_path / "run.vtkhdf"
    given.watch.halvings, given.watch.speed = 2, 1.0  # what falls from the start reaches that, whatever the step
    heard = Heard()
    with pytest.raises(Unstable, match=r"\(watch.speed\).* Steps of 0.015 s, halved 2 times \(watch.halvings\), do not help"):
        simulation.run(given, path, backend="cpu", progress=heard, on_unstable="halve")
    assert len(heard.words) == 2 and len(open_run(path)) >= 1


# ---- a fault planted in a stage


def plant(monkeypatch, heard, wrong):
    """Let tait_pressure yield NaN for the first liquid particle where ``wrong(clock)`` says so."""
    real = pressure.tait_pressure

    def faulty(*arguments):
        real(*arguments)
        if heard.sim is not None and wrong(heard.sim.do.clock):
            arguments[-1][np.argmax(arguments[0] == 0)] = np.nan

    class Planted:  # the compiler is asked about the real one
        __call__ = staticmethod(faulty)
        __getattr__ = staticmethod(lambda name: getattr(real, name))

    monkeypatch.setattr(pressure, "tait_pressure", Planted())


def test_a_stage_that_yields_nan_is_named_with_what_it_was_given(monkeypatch, tmp_path):
    heard, path = Heard(), tmp_path / "run.vtkhdf"
    plant(monkeypatch, heard, lambda clock: clock.time > 0.021)
    said = (
        r"step 5, t = 0.025 s: .* Stage tait_pressure \(call \d+ of step 5, from t = 0.02\d* s\) is the first to write what is "
        r"not finite: pressure\[\d+\] of particle \d+, position .* m, from inputs that are good"
    )
    with pytest.raises(Unstable, match=said):
        simulation.run(scene(), path, backend="cpu", progress=heard)
    found = capsule.read(capsule.beside(path))
    assert (found.stage, found.facts["field"]) == ("tait_pressure", "pressure")
    assert np.isfinite(found.arrays["density"]).all() and np.isnan(found.outputs["pressure"]).sum() == 1
    assert capsule.read(capsule.beside(path)).params["fluid"] == heard.sim.prepared.params["fluid"]
    assert len(open_run(path)) == 3  # t = 0, 0.01, 0.02


def test_what_came_from_outside_is_told_from_what_a_stage_did(tmp_path):
    running = Heard()

    def meddle(event, step=0, **values):
        running(event, **values)
        if event == "step" and step == 3:
            values = running.sim.state.read("velocity")
            values[2, 5] = np.nan
            running.sim.state.set("velocity", values)

    with pytest.raises(Unstable, match=r"Repeated from step 2 on it does not happen: what is wrong came from outside"):
        simulation.run(scene(), tmp_path / "run.vtkhdf", backend="cpu", progress=meddle)
    assert not (tmp_path / "run.vtkhdf.capsule.h5").exists()


def test_a_full_disk_does_not_hide_the_alarm(monkeypatch, tmp_path):
    def full(path, data):
        raise OutputError(f"cannot write {path}: the disk is full.")

    heard = Heard()
    plant(monkeypatch, heard, lambda clock: clock.time > 0.021)
    monkeypatch.setattr(capsule, "write_whole", full)
    with pytest.raises(Unstable, match=r"step 5, t = 0.025 s: field .* No capsule could be written: cannot write .* disk is full"):
        simulation.run(scene(), tmp_path / "run.vtkhdf", backend="cpu", progress=heard)


def test_a_halved_step_is_doubled_when_it_was_quiet_and_a_resumed_run_is_the_same_bit_by_bit(monkeypatch, tmp_path):
    heard = Heard()
    plant(monkeypatch, heard, lambda clock: 0.022 < clock.time < 0.024 and clock.halvings == 0)
    given = scene(time={"end": 0.08}, watch={"quiet": 4, "on_unstable": "halve"})
    whole, part = tmp_path / "whole.vtkhdf", tmp_path / "part.vtkhdf"
    simulation.run(given, whole, backend="cpu", progress=heard)
    assert "Back to t = 0.02 s (step 4), on with steps of 0.0025 s" in heard.words[0]
    assert heard.words[1:] == ["t = 0.045 s: no alarm for a while, steps of 0.005 s again"]
    with open_run(whole) as run:
        assert run.series["halvings"].tolist() == [0, 0, 0, 1, 1, 0, 0, 0, 0]
    for until in (0.03, None):  # it is halved when the first part ends
        if until:
            simulation.run(given, part, backend="cpu", progress=heard, until=until)
        else:
            simulation.resume(part, progress=heard)
    a, b = datasets(whole), datasets(part)
    assert [n for n in a if not np.array_equal(a[n], b[n], equal_nan=a[n].dtype.kind == "f")] == []


def test_a_stopped_run_resumed_with_halved_steps_is_as_one_that_halved_at_once(monkeypatch, tmp_path):
    heard = Heard()
    plant(monkeypatch, heard, lambda clock: 0.022 < clock.time < 0.024 and clock.halvings == 0)
    given = scene(time={"end": 0.06}, watch={"quiet": 4})
    halved, stopped = tmp_path / "halved.vtkhdf", tmp_path / "stopped.vtkhdf"
    simulation.run(given, halved, backend="cpu", progress=heard, on_unstable="halve")
    with pytest.raises(Unstable, match=r"step 5, t = 0.025 s"):
        simulation.run(given, stopped, backend="cpu", progress=heard)
    simulation.resume(stopped, progress=heard, until=0.03, on_unstable="halve")
    simulation.resume(stopped, progress=heard)  # by the answer of the scene again, and with the steps as they are
    a, b = datasets(halved), datasets(stopped)
    assert set(a) == set(b)
    differ = [n for n in a if not np.array_equal(a[n], b[n], equal_nan=a[n].dtype.kind == "f")]
    assert differ == ["melt/scene"]  # which tells the answer that the run was started with
    assert open_run(stopped).provenance["alarms"] == open_run(halved).provenance["alarms"]


# ---- what must not alarm


@pytest.mark.parametrize("given", [scene, flood, pool, lambda: tank((5, 5), 3)], ids=["melting", "flood", "slime", "boiling"])
def test_no_stage_of_a_sound_step_is_blamed(given):
    """Infinities that mean something, and what lies behind the end of a list, are no fault."""
    sim = Simulation(given(), "cpu")
    sim.step()
    sim.do = Watched(sim.do, Unstable(""))
    sim.step()
    assert sim.do.found is None


def test_an_unknown_answer_to_alarms_is_refused():
    with pytest.raises(MeltError, match="on_unstable = 'pray' is not known: use stop or halve"):
        simulation.run(scene(), on_unstable="pray")
