"""Find the stage that is to blame for an alarm: repeat the failing step and look at what each stage wrote."""

from typing import NamedTuple

import numpy as np

from melt.bind import Plain
from melt.errors import Unstable
from melt.fields import FIELDS
from melt.finite import active_of, bad_values
from melt.stages import STAGES
from melt.watch.alarms import particle

#: Fields in which a speed alarm is looked for.
SPEEDS = {name for name, field in FIELDS.items() if field.scale == "speed" and field.shape in (("3", "particle"), ("3", "apic"))}


class Culprit(NamedTuple):
    """One call of a stage, with all that it was given and what it made of it."""

    stage: str
    call: int  # of this stage in its outer step, from 1
    step: int  # outer step
    time: float  # at the start of the sub-step [s]
    arrays: dict  # argument -> array before the call
    params: dict  # argument -> parameters
    outputs: dict  # argument -> array after the call
    field: str = ""  # that went bad in it; "" for a call that shows how a solve ended
    index: tuple = ()  # of the first bad element
    others: int = 0  # bad elements beside it
    who: str = ""  # whose it is, in words; "" for an element of no particle
    before: str = ""  # inputs that were bad already
    speed: float = 0.0  # the bound [m/s], if it is a speed that went beyond it


def culprit(sim, state, begun, alarm):
    """Return the `Culprit` of an alarm in the step after ``begun``; None if the alarm does not come again.

    ``state`` is a checkpoint from which the run went there. The run is left within the failing step.
    """
    sim.rewind(*state)
    while sim.do.clock.step <= begun:
        before = sim.checkpoint()
        if _alarms(sim):
            break
    else:
        return None
    sim.rewind(*before)
    own, sim.do = sim.do, Watched(sim.do, alarm)
    try:
        _alarms(sim)
        return sim.do.found or sim.do.last
    finally:
        sim.do = own


def _alarms(sim):
    try:
        sim.step()
        sim.check()
    except Unstable:
        return True
    return False


class Watched(Plain):
    """Run stages and keep the first call whose inputs are good and whose outputs are not.

    Attributes:
        found: that call, or None.
        last: the last call of the stage that the alarm names, or None.
    """

    def __init__(self, of, alarm):
        super().__init__(of.backend, of.state, of.params, of.need, of.settings, of.clock)
        self.alarm, self.found, self.last = alarm, None, None
        self._renamed = {}

    def run(self, name, scalars):
        self._renamed = {argument: value for argument, value in scalars.items() if isinstance(value, str)}
        super().run(name, scalars)

    def _call(self, stage, arguments):
        if self.found or stage.name.startswith("reorder_"):  # they only move values
            return super()._call(stage, arguments)
        given = dict(zip(stage.arguments, arguments))
        host = {name: self.backend.download(value) for name, value in given.items() if name not in stage.params}
        super()._call(stage, arguments)
        wrote = {name: self.backend.download(given[name]) for name in stage.writes}
        clock = self.clock
        call = Culprit(
            stage.name, self.launches[stage.name], clock.step + 1, clock.time, host, {name: given[name] for name in stage.params}, wrote
        )
        active = active_of(self.state)
        for name in stage.writes:
            if name not in stage.scratch:
                bad = self._bad(name, wrote[name], active)
                if bad is not None and (bad := bad & ~self._bad(name, host[name], active)).any():
                    self.found = self._told(call, name, bad, active)
                    return
        if stage.name == self.alarm.stage:
            self.last = call

    def _bad(self, argument, values, active):
        """Return where an array holds what the alarm is about; None for integers and what is not watched."""
        name = self._renamed.get(argument, argument)
        if values.dtype.kind != "f" or not values.size:
            return None
        bad = bad_values(name, values, active)
        if self.alarm.speed is not None and name in SPEEDS:
            with np.errstate(over="ignore", invalid="ignore"):
                bad |= np.linalg.norm(values.astype(np.float64), axis=0) > self.alarm.speed
        return bad

    def _told(self, call, argument, bad, active):
        """Return the call with what went bad in it, and whose it is."""
        name = self._renamed.get(argument, argument)
        index = np.unravel_index(int(np.argmax(bad)), bad.shape)
        who = ""
        for extent, value in zip(FIELDS[name].shape, index):
            if extent in active:
                who = particle(self, value, "apic_" if extent == "apic" else "")
        read = {a: self._bad(a, call.arrays[a], active) for a in STAGES[call.stage].reads}
        speed = self.alarm.speed if self.alarm.speed and name in SPEEDS else 0.0
        before = ", ".join(a for a, b in read.items() if b is not None and b.any())
        return call._replace(field=argument, index=tuple(map(int, index)), others=int(bad.sum()) - 1, who=who, before=before, speed=speed)


def described(found):
    """Return in words which call is to blame."""
    where = f"call {found.call} of step {found.step}, from t = {found.time:.6g} s"
    if not found.field:
        return f"The last call of stage {found.stage} before it is {where}."
    what = f"is beyond {found.speed:.3g} m/s" if found.speed else "is not finite"
    element = f"{found.field}[{', '.join(map(str, found.index))}]" + (f" of {found.who}" if found.who else "")
    more = f" (and {found.others} more)" if found.others else ""
    clean = f"; its inputs {found.before} were so before, from outside" if found.before else ", from inputs that are good"
    return f"Stage {found.stage} ({where}) is the first to write what {what}: {element}{more}{clean}."
