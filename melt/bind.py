"""Binders: run the stages that a step page calls, filling their arguments by name.

A step page is written once, ``page(do)``, and serves all backends:

``Plain``     runs the stages
``Timed``     and gives milliseconds per stage
``Lockstep``  gives a second backend the same inputs before each stage and compares after it
``Recorder``  runs nothing and lists what would run: `melt.plan` derives the plan from it

``do.stage(dt=0.1)`` gives a scalar, ``do.stage(cell="bubble_cell")`` lets the stage work on another field.
"""

import time
from types import SimpleNamespace

import numpy as np

from melt.check.compare import SENTINEL, difference, meaning, stage_function
from melt.errors import MeltError
from melt.fields import CARRIED, FIELDS
from melt.stages import STAGES
from melt.state import REAL


def new_clock():
    """Return the times and counters of a run at its start (a checkpoint keeps them)."""
    return SimpleNamespace(
        time=0.0, step=0, previous_dt=0.0, max_speed=0.0, max_acceleration=0.0, active=0, layers={},
        entered={}, origin_time=0.0, origin_step=0, melted=0, frozen=0, energy_in=0.0,
        sub_step=0, bubbles=0, largest_bubble=0.0, next_id=0, ledger={}, largest_support=0.0, sources={}, readings=[],
        apic=0, largest_affine=0.0, tally={}, halvings=0, doublings=0, halved_until=0, alarms=[],
    )


class Plain:
    """Run stages on one backend.

    Attributes a step page may use: ``need`` (what the scene requires), ``settings`` (run-time
    choices), ``params`` (parameter tuples by registry name), ``clock`` (times that a checkpoint
    keeps), ``notes`` (values of this output step for ``/melt/series``).
    """

    recording = False

    def __init__(self, backend, state, params, need, settings, clock=None):
        self.backend, self.state, self.params = backend, state, params
        self.need, self.settings = need, settings
        self.clock = clock or new_clock()
        self.notes = {}
        self.warning = ""  # why the last step may be unstable
        self.listed = False  # neighbour lists are valid for good (nothing moves)
        self.launches = {}
        self._real = REAL[state.precision]
        self._bound = {}
        self._spare = {}

    def __getattr__(self, name):
        if name not in STAGES:
            raise AttributeError(f"no stage called {name!r}")
        return lambda **scalars: self.run(name, scalars)

    def _cast(self, value):
        return np.int32(value) if isinstance(value, (int, np.integer)) else self._real(value)

    def arguments(self, stage, scalars):
        """Return the argument list of ``stage``; arrays are looked up again only after a swap."""
        version, cached = self._bound.get(stage.name, (-1, None))
        if version != self.state.version:
            named = [self.params.get if a in stage.params or a not in FIELDS else self.state.get for a in stage.arguments]
            cached = [get(a) for get, a in zip(named, stage.arguments)]
            self._bound[stage.name] = (self.state.version, cached)
        arguments = list(cached)
        for k, name in enumerate(stage.arguments):
            if isinstance(scalars.get(name), str):  # the stage works on another field
                arguments[k] = self.state.get(scalars[name])
            elif name in scalars:
                arguments[k] = self._cast(scalars[name])
            elif arguments[k] is None:
                raise TypeError(f"stage {stage.name}: no parameter {name!r} was given")
        return arguments

    def run(self, name, scalars):
        """Run the stage ``name``."""
        stage = STAGES[name]
        self.launches[name] = self.launches.get(name, 0) + 1
        self._call(stage, self.arguments(stage, scalars))

    def _call(self, stage, arguments):
        stage_function(stage.name, self.backend.folder)(*arguments)

    def swap(self, first, second):
        """Exchange two arrays (the ends of a double buffer)."""
        self.state.swap(first, second)

    def read(self, name):
        """Return a host copy of a field: a declared read-back."""
        return self.state.read(name)

    def give(self, name, values):
        """Hand host values to a field: a declared upload."""
        self.state.set(name, values)

    def forget(self):
        """Look arguments up anew: parameters were changed by hand."""
        self._bound.clear()

    def size(self, extent):
        """Return the size of an extent."""
        return self.state.sizes[extent]

    def has(self, name):
        """Return whether the run has a field."""
        return name in self.state

    def resize(self, extent, size):
        """Give every array with this extent the new size; contents are lost."""
        self.state.resize(extent, size)

    def note(self, name, value):
        """Keep a value for the series of this output step."""
        self.notes[name] = value

    def reorder(self, names=CARRIED, order="order"):
        """Sort every field that travels with its particle into cell order."""
        for name in names:
            if name in self.state:
                self._reorder(name, order)

    def _reorder(self, name, order):
        source = self.state.get(name)
        key = (source.shape, source.dtype.str)
        if key not in self._spare:
            self._spare[key] = self.backend.upload(np.empty(source.shape, source.dtype))
        target = self._spare[key]
        stage = STAGES["reorder_scalar" if len(source.shape) == 1 else "reorder_vector"]
        self.launches[stage.name] = self.launches.get(stage.name, 0) + 1
        self._call(stage, [self.state.get(order), source, target])
        self._spare[key] = source
        self.state.arrays[name] = target
        self.state.version += 1


class Timed(Plain):
    """Run stages and add up their wall time. ``seconds`` maps stage to total seconds."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.seconds = {}

    def _call(self, stage, arguments):
        start = time.perf_counter()
        super()._call(stage, arguments)
        self.backend.synchronize()
        self.seconds[stage.name] = self.seconds.get(stage.name, 0.0) + time.perf_counter() - start


class LockstepError(MeltError):
    """Two backends parted at a stage of a live run."""


class Lockstep(Plain):
    """Run each stage on a second backend too, with the same inputs, and compare its outputs.

    The leader's results go on. ``worst`` maps (stage, field) to the largest `Difference` seen.
    """

    def __init__(self, backend, state, params, need, settings, clock=None, *, follower, scales, stop=True):
        super().__init__(backend, state, params, need, settings, clock)
        self.follower, self.scales, self.stop = follower, scales, stop
        self.worst = {}

    def _call(self, stage, arguments):
        names = stage.arguments
        mirrored = []
        for name, value in zip(names, arguments):
            if name in stage.params:
                mirrored.append(value)
                continue
            host = self.backend.download(value)
            if name in stage.writes and name not in stage.reads and not stage.partial:
                host.fill(np.nan if host.dtype.kind == "f" else SENTINEL)
            mirrored.append(self.follower.upload(host))
        super()._call(stage, arguments)
        stage_function(stage.name, self.follower.folder)(*mirrored)
        written = [(k, n) for k, n in enumerate(names) if n in stage.writes and n not in stage.scratch]
        led = {name: self.backend.download(arguments[k]) for k, name in written}
        for k, name in written:
            followed, mask = self.follower.download(mirrored[k]), meaning(name, led)
            if mask is not None:  # what means nothing is not compared
                followed = np.where(mask, followed, led[name])
            self._compare(stage, name, led[name], followed)

    def _compare(self, stage, field, led, followed):
        found = difference(stage.name, field, led, followed, self.state.precision, self.scales)
        key = (stage.name, field)
        if key not in self.worst or found.ratio > self.worst[key].ratio:
            self.worst[key] = found
        if self.stop and found.ratio > 1:
            particle = found.index[-1] if FIELDS.get(field) and FIELDS[field].shape[-1] == "particle" else None
            where = f"particle {particle} (index {found.index})" if particle is not None else f"index {found.index}"
            raise LockstepError(
                f"{self.backend.name} and {self.follower.name} part at t = {self.clock.time:.6g} s in stage "
                f"{stage.name}, field {field}, {where}: {found.reference!r} against {found.got!r}, "
                f"{found.ratio:.3g} times the tolerance"
            )


class Recorder:
    """List the stages, fields and parameters that a step page would use, running nothing.

    Reads return ones, integers 100, so that a page goes through the branch where something happened.
    """

    recording = True

    def __init__(self, params, need, settings):
        self.params, self.need, self.settings = params, need, settings
        self.clock = new_clock()
        self.clock.largest_bubble = np.inf
        self.notes = {}
        self.warning = ""
        self.listed = False
        self.stages = []
        self.fields = []
        self.renamed = {}  # stage: the other fields that it works on

    def __getattr__(self, name):
        if name not in STAGES:
            raise AttributeError(f"no stage called {name!r}")
        return lambda **scalars: self.run(name, scalars)

    def run(self, name, scalars=None):
        if name not in self.stages:
            self.stages.append(name)
        if any(isinstance(v, str) for v in (scalars or {}).values()):
            self.renamed.setdefault(name, scalars)
        for field in STAGES[name].reads + STAGES[name].writes:
            other = (scalars or {}).get(field)
            self._use(other if isinstance(other, str) else field)

    def _use(self, field):
        if field in FIELDS and field not in self.fields:
            self.fields.append(field)

    def swap(self, first, second):
        self._use(first)
        self._use(second)

    def read(self, name):
        self._use(name)
        shape = [int(e) if e.isdigit() else 1 for e in FIELDS[name].shape]
        return np.full(shape, 100) if FIELDS[name].kind == "int" else np.ones(shape)

    def give(self, name, values):
        self._use(name)

    def size(self, extent):
        return 100

    def note(self, name, value):
        pass

    def forget(self):
        pass

    def reorder(self, names=CARRIED, order="order"):
        for stage in ("reorder_scalar", "reorder_vector"):
            if stage not in self.stages:
                self.stages.append(stage)
