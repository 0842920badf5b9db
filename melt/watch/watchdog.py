"""The watchdog of a run: on an alarm it finds the stage to blame, writes its capsule, and stops or goes on with half the step.

The last good state is a checkpoint in memory, taken with every frame and file checkpoint, and every `KEEP_EVERY` outer
steps between them: a step that goes well pays for no more than the look for values that are not finite. The run goes
back to it, never behind a frame that was written.
"""

from melt.errors import MeltError, Unstable
from melt.scales import scales_of
from melt.stages import STAGES
from melt.watch import capsule
from melt.watch.hunt import culprit, described

KEEP_EVERY = 64  # outer steps between good states at most


def told(scene, on_unstable):
    """Return the scene, with ``watch.on_unstable`` as asked for.

    Raises:
        MeltError: it is neither stop nor halve.
    """
    if on_unstable is None or on_unstable == scene.watch.on_unstable:
        return scene
    if on_unstable not in ("stop", "halve"):
        raise MeltError(f"on_unstable = {on_unstable!r} is not known: use stop or halve")
    return scene.model_copy(update={"watch": scene.watch.model_copy(update={"on_unstable": on_unstable})})


class Watchdog:
    """Steps a run, and deals with its alarms.

    Args:
        sim: `melt.simulation.Simulation`. writer: of the run file, or None. say: ``say(event, message=...)``.

    Attributes:
        begun: (step, time [s]) at which the last step began. written: name of the capsule of the last alarm, or "".
    """

    def __init__(self, sim, writer, say):
        self.sim, self.say, self.watch = sim, say, sim.scene.watch
        self.path = capsule.beside(writer.path) if writer and self.watch.capsule else None
        self.begun, self.written = (sim.do.clock.step, sim.time), ""
        self.good = sim.checkpoint()

    def step(self):
        """Advance by one outer step; return False if the run went back instead.

        Raises:
            Unstable: an alarm that stops the run.
        """
        sim, begun = self.sim, self.sim.do.clock.step
        self.begun = begun, sim.time
        try:
            sim.step()
            if self._due(begun + 1):
                sim.check()
        except Unstable as alarm:
            self._alarmed(alarm, begun)
            return False
        self._recover()
        return True

    def keep(self, last=False):
        """Keep the state of now if it is time for that; return the last good state."""
        if last or self._due(self.sim.do.clock.step):
            self.good = self.sim.checkpoint()
        return self.good

    def _due(self, step):
        t = self.sim.scene.time
        return not all(step % every for every in (t.output_steps, t.checkpoint_steps or t.output_steps, KEEP_EVERY))

    def _alarmed(self, alarm, begun):
        """Explain an alarm in the step after ``begun``; go back with half the step, or raise it with its explanation."""
        w, clock = self.watch, self.sim.do.clock
        halvings, doublings, alarms, dt = clock.halvings, clock.doublings, clock.alarms, self.sim.scene.time.dt
        bound = _bound(self.sim.do)
        stage, inputs = self._explained(alarm, begun) if w.capsule else ("", "")
        told = [" ".join(filter(None, (*alarm.more, stage))), bound]
        if w.on_unstable == "stop" or halvings >= w.halvings:
            last = "With --on-unstable halve it goes back to the last good state, and on with half the step."
            if w.on_unstable == "halve":
                last = f"Steps of {dt / 2**halvings:.3g} s, halved {halvings} times (watch.halvings), do not help: change the scene."
            remedy = " ".join(filter(None, (alarm.remedy, last)))
            raise Unstable(alarm.what, *told, remedy, inputs, stage=alarm.stage, speed=alarm.speed) from alarm
        self.sim.rewind(*self.good)
        clock.halvings, clock.doublings = halvings + 1, doublings
        clock.halved_until = begun + 1 + w.quiet * 2**doublings
        news = f"Back to t = {self.sim.time:.5g} s (step {clock.step}), on with steps of {dt / 2**clock.halvings:.3g} s"
        clock.alarms = [*alarms, " ".join((alarm.what, *alarm.more, news))]  # without remedies
        self.good = self.sim.checkpoint()
        self.say("unstable", message="\n".join(filter(None, (alarm.what, *told, alarm.remedy, inputs, news))))

    def _recover(self):
        """Double a halved step that has been quiet for long enough."""
        w, clock = self.watch, self.sim.do.clock
        if not (clock.halvings and w.quiet and clock.step >= clock.halved_until):
            return
        clock.halvings, clock.doublings = clock.halvings - 1, clock.doublings + 1
        clock.halved_until = clock.step + w.quiet * 2**clock.doublings
        self.good = self.sim.checkpoint()
        dt = self.sim.scene.time.dt / 2**clock.halvings
        self.say("unstable", message=f"t = {self.sim.time:.5g} s: no alarm for a while, steps of {dt:.3g} s again")

    def _explained(self, alarm, begun):
        """Return in words (which stage is to blame, where its capsule is); what fails here never hides the alarm."""
        stage = self.written = ""
        try:
            found = culprit(self.sim, self.good, begun, alarm)
            if found is None:
                return (
                    f"Repeated from step {self.good[1]['clock']['step']} on it does not happen: what is wrong came from outside of the "
                    "stages (arrays changed by hand, or the memory of the machine).", ""
                )  # fmt: skip
            stage = described(found)
            if self.path is None:
                return stage, ""
            size, self.written = self._write(found, alarm), self.path.name
        except (MeltError, OSError, MemoryError) as error:
            return stage, f"No capsule could be written: {error}"
        replay = f"replay them on every backend: `melt check --capsule {self.path}`."
        return stage, f"The inputs of that call are in {self.path} ({size / 1e3:.3g} kB); {replay}"

    def _write(self, found, alarm):
        sim = self.sim
        return capsule.write(
            self.path, found, scales_of(sim.scene, sim.initial, sim.prepared.settings), backend=sim.backend.name,
            precision=sim.prepared.precision, alarm=str(alarm), who=found.who, speed=found.speed,
            arguments=" ".join(STAGES[found.stage].arguments),
            scene=sim.scene.to_toml(),
        )


def _bound(do):
    """Return in words which bound governed the length of the last sub-step, and how far it was used."""
    notes = do.notes
    if notes.get("governing_bound") == "given" and do.warning:  # that says it all
        return f"Before: {do.warning}."
    if "step_over_limit" not in notes:
        return ""
    return f"The sub-step was {notes['step_over_limit']:.3g} of what its bound allows ('{notes['governing_bound']}' governs)."
