"""Run a scene: the loop around a step page, with frames, checkpoints, ledgers and clean ends."""

import copy
import pathlib

import numpy as np

from melt import backend as backends
from melt import plan
from melt.ahead import compile_ahead
from melt.bind import Lockstep, Plain, Timed, new_clock
from melt.errors import MeltError
from melt.fields import FIELDS, owned
from melt.finite import CHECK_EVERY, check_initial, check_number, check_state
from melt.flood.maps import check_beside
from melt.geometry.build import build
from melt.geometry.lattice import lattice_fields
from melt.output import checkpoint
from melt.physics.phases import AIRBORNE, BUBBLE, DRIVEN, LIQUID, SOLID, VAPOUR, WALL
from melt.preflight import findings
from melt.scales import scales_of
from melt.scene import load_scene, scene_from_toml
from melt.scene.model import OUTPUT_FIELDS
from melt.state import State
from melt.stepping import append_frame, in_pieces, loop
from melt.watch import capsule
from melt.watch.alarms import bounds_of, check_density
from melt.watch.watchdog import told

#: Names of the time-step bounds, in the order of their number in ``series/governing_bound``.
BOUNDS = (
    "given", "sound", "force", "speed", "viscosity", "light solid", "compression", "wave", "terrain", "fall",
    "gravity", "affine", "elastic", "capillary",
)


class Simulation:
    """One run of a scene on one backend, stepped by hand.

    Args:
        scene: a `melt.scene.Scene`, or what `load_scene` takes.
        backend: auto, cpu, cuda, reference, cuda-emulated, cuda-simulated.
        precision: single, mixed, double; the scene's unless given.
        timed: keep seconds per stage in ``do.seconds``.
        lockstep: name of a second backend that runs beside and is compared stage by stage.
        progress: called as ``progress("compile", message=..., done=..., total=...)``.
    """

    def __init__(self, scene, backend="auto", precision=None, timed=False, lockstep=None, initial=None, progress=None):
        self.scene = load_scene(scene) if isinstance(scene, (str, pathlib.Path)) else scene
        self.initial = initial or build(self.scene)
        check_initial(self.initial, precision or self.scene.solver.precision)
        self.prepared = plan.prepare(self.scene, self.initial, precision)
        self.backend = backends.load(backend) if isinstance(backend, str) else backend
        p = self.prepared
        backends.check_memory(p.nbytes)
        if p.need.solids:
            sites = (self.initial[n] for n in ("site_cell", "site_body", "site_particle"))
            self.initial.arrays.update(lattice_fields(*sites, connect=self.scene.solver.connect))
        self.initial.arrays.update(plan.derived_fields(self.scene, self.initial, p))
        self.state = State(self.backend, p.precision, p.sizes, p.fields)
        given = (self.state, p.params, p.need, p.settings)
        if lockstep:
            follower = backends.load(lockstep)
            scales = scales_of(self.scene, self.initial, p.settings)
            self.do = Lockstep(self.backend, *given, follower=follower, scales=scales)
        else:
            self.do = (Timed if timed else Plain)(self.backend, *given)
        self._timed_from = self._notes_from = 0
        self.lost_told, self.told = False, set()  # kinds of warnings, by their first word
        self._fingerprint = checkpoint.fingerprint(self.scene.to_toml())
        self.bounds = bounds_of(self.scene, self.initial, p.settings)
        self._set_initial()
        self.compile_seconds = compile_ahead(self.do, p.stages, p.renamed, progress)
        p.system.start(self.do)
        mobile = np.isin(self.initial["phase"], (LIQUID, SOLID, AIRBORNE))
        self._start = {
            "solids": int((self.initial["phase"] == SOLID).sum()),
            "liquids": int((self.initial["phase"] == LIQUID).sum()),
            "mass": float(self.initial["mass"][mobile].sum()),
            "mass_entered": self._mass_entered,
        }

    def _set_initial(self):
        """Bring all arrays and times to what they are before the system starts."""
        for name in self.prepared.fields:
            if name in self.initial:
                self.state.set(name, self.initial[name])
            else:
                self.state.allocate(name)
        # liquids start at their rest density: what reads it before the first density pass sees that
        used = np.maximum(self.initial["rest_volume"], 1e-300)
        for name, values in (("density", self.initial["mass"] / used), ("volume", self.initial["rest_volume"])):
            if name in self.state:
                self.state.set(name, values)
        do, clock = self.do, self.do.clock
        vars(clock).update(vars(new_clock()))
        clock.active, clock.max_speed = self.initial.active, self.initial.top_speed
        clock.layers = dict.fromkeys((n.name for n in self.initial.nozzles), 0)
        do.notes, do.warning, do.listed = {}, "", False

    def _mass_entered(self, clock):
        mass = self.initial["inflow_mass"] if self.initial.nozzles else None
        return sum(
            clock.entered.get(n.name, 0) * float(mass[n.first : n.first + n.count].sum()) for n in self.initial.nozzles
        )

    @property
    def time(self):
        """Simulated time [s]."""
        return self.do.clock.time

    def step(self, dt=None):
        """Advance by one outer step (the scene's dt unless given).

        Raises:
            Unstable: an alarm of the watchdog (what, where, remedy).
            InputError: dt is not a positive number.
        """
        do, clock = self.do, self.do.clock
        before = clock.time
        if dt is not None:
            check_number("dt", dt, above=0)
        if clock.step == self._notes_from:  # what happened before the last frame was told in it
            do.notes.clear()
        in_pieces(self, dt or self.scene.time.dt)
        # exact multiples of dt: no drift of the output times by rounding
        if dt:
            clock.origin_time, clock.origin_step = before + dt, clock.step
        clock.time = clock.origin_time + (clock.step - clock.origin_step) * self.scene.time.dt
        if not self.backend.on_device or clock.step % CHECK_EVERY == 0:
            self.check()

    def check(self):
        """Raise `Unstable` if a value of a particle is not finite, or the liquid is compressed beyond reason."""
        check_state(self)
        check_density(self)

    def read(self, name):
        """Return a field in order of particle id, as NumPy, component last: (n,) or (n, 3)."""
        values = self.state.read(name)
        if FIELDS[name].shape[-1] == "particle":
            values = values[..., np.argsort(self.state.read("id"), kind="stable")]
        return values.T if values.ndim == 2 else values

    def frame(self):
        """Return the particle arrays of a frame: what the run file gets, sorted by id."""
        output = self.scene.output
        phases = [LIQUID, SOLID, BUBBLE, VAPOUR, AIRBORNE, DRIVEN] + ([WALL] if output.walls else [])
        keep = np.isin(self.read("phase"), phases)
        # a position based fluid sums no density: with solids stages are handed one, which does not travel with the particles
        unsummed = {"density"} if getattr(self.prepared.need, "pbf", False) else set()
        names = [n for n in self.prepared.fields if n in OUTPUT_FIELDS and n not in unsummed]
        if output.fields != "all":
            names = [n for n in names if n in (*output.fields, "id", "phase", "position")]
        return {n: owned(n, self.read(n), self.read("phase"))[keep] for n in names}

    def series(self):
        """Return the ledgers and notes of now, as {name: number}."""
        clock, notes = self.do.clock, self.do.notes
        values = {"dt": self.scene.time.dt / 2**clock.halvings, "step": clock.step, **self.prepared.ledger.series(self.do, self._start)}
        for name, value in notes.items():
            values[name] = BOUNDS.index(value) if name == "governing_bound" else value
        steps = max(1, clock.step - self._timed_from)
        if self.scene.watch.on_unstable == "halve" or clock.alarms:
            values |= {"halvings": clock.halvings, "alarms": len(clock.alarms)}
        for name, seconds in getattr(self.do, "seconds", {}).items():
            values[f"ms/{name}"] = 1e3 * seconds / steps
        return values

    def readings(self):
        """Return what the gauges read since the last call: name -> array (k,) or (k, gauges)."""
        taken, self.do.clock.readings = self.do.clock.readings, []
        return {name: np.array([reading[name] for reading in taken]) for name in (taken[0] if taken else ())}

    def restart_timers(self):
        """Begin the milliseconds per stage and outer step (``ms/*`` of `series`), and the notes, anew."""
        self._timed_from = self._notes_from = self.do.clock.step
        if hasattr(self.do, "seconds"):
            self.do.seconds.clear()

    def checkpoint(self):
        """Return (arrays, meta) from which `restore` continues bit-identically."""
        arrays = {n: self.state.read(n) for n in plan.carried(self.prepared)}
        scene, precision = self._fingerprint, self.prepared.precision
        notes = {k: v.item() if isinstance(v, np.generic) else v for k, v in self.do.notes.items()}
        meta = {"clock": copy.deepcopy(vars(self.do.clock)), "precision": precision, "scene": scene}
        return arrays, meta | {"notes": notes, "notes_from": self._notes_from}

    def restore(self, arrays, meta):
        """Continue from `checkpoint`; `MeltError` if it is of another scene."""
        if meta.get("scene") != self._fingerprint or set(arrays) != set(plan.carried(self.prepared)):
            raise MeltError("the checkpoint is of another scene than the run beside it: start the run afresh")
        for name, values in arrays.items():
            self.state.set(name, values)
        vars(self.do.clock).update(copy.deepcopy(meta["clock"]))
        self.restart_timers()
        self.do.notes, self._notes_from = dict(meta["notes"]), meta["notes_from"]

    def rewind(self, arrays, meta):
        """Go back to a `checkpoint` of this run: nothing that was there since has a part in what follows."""
        self._set_initial()
        self.prepared.system.start(self.do)
        self.restore(arrays, meta)


def run(
    scene, output=None, backend="auto", precision=None, threads=None, progress=None, overwrite=False,
    lockstep=None, until=None, on_unstable=None, facts=None,
):
    """Run a scene and write its run file.

    Args:
        scene: a `Scene` or its name or path.
        output: run file; nothing is written for None.
        threads: CPU threads.
        progress: called as ``progress(event, **values)``: start, warning, step, frame, end.
        overwrite: replace an existing run file.
        lockstep: second backend to compare with, stage by stage.
        until: end time in place of the scene's [s].
        on_unstable: ``stop`` or ``halve`` in place of the scene's ``watch.on_unstable``.
        facts: {name: text} that the provenance of the file shall tell too.

    Returns:
        SimpleNamespace with ``simulation``, ``interrupted`` (Ctrl-C ended it) and ``seconds``.

    Raises:
        MeltError: bad scene, output that cannot be written, an alarm that halved steps cannot heal (`Unstable`).
    """
    from melt.output.provenance import provenance
    from melt.output.run_file import RunWriter

    say = progress or (lambda event, **values: None)
    backends.set_threads(threads)
    scene = load_scene(scene) if isinstance(scene, (str, pathlib.Path)) else scene
    scene = told(scene, on_unstable)
    total = scene.time.steps_to(check_number("until", scene.time.end if until is None else until, at_least=0))
    initial = build(scene)
    chosen = backends.load(backend)
    if lockstep:
        backends.load(lockstep)
    writer = None
    check_initial(initial, precision or scene.solver.precision)
    # what cannot run is known before the compiler runs
    backends.check_memory(plan.prepare(scene, initial, precision).nbytes)
    if output is not None:  # before the compiler runs: a bad path must not cost a minute
        if scene.kind == "flood" and not overwrite:
            check_beside(scene, pathlib.Path(output))
        facts = provenance(chosen.name, precision or scene.solver.precision, threads) | (facts or {})
        writer = RunWriter(output, scene.to_toml(), facts, overwrite=overwrite)
    try:
        sim = Simulation(scene, chosen, precision, not chosen.on_device, lockstep, initial, progress=say)
        for finding in findings(scene, initial, sim.prepared):
            if finding.level == "warning" or finding.text in initial.notes:
                say("warning", message=finding.advice)
                sim.told.add(finding.text.split()[0])
        if writer:
            if sim.prepared.begin:
                sim.prepared.begin(sim, writer)
            sim.check()
            append_frame(writer, sim, say)
            for older in (checkpoint.beside(writer.path), capsule.beside(writer.path)):  # of the run that it replaced
                checkpoint.discard(older)
        return loop(sim, writer, say, total)
    finally:
        if writer:  # if it failed before the first frame nothing is worth keeping
            writer.close(keep_empty=False)


def resume(path, backend=None, threads=None, progress=None, until=None, on_unstable=None):
    """Continue a run from its last checkpoint; the result equals an uninterrupted run bit by bit. Arguments: of `run`.

    Raises:
        MeltError: no run file, no checkpoint, or a file that is not one of melt's.
    """
    from melt.output.run_file import RunWriter, followed
    from melt.output.run_reader import open_run

    path, say = followed(path), progress or (lambda event, **values: None)
    backends.set_threads(threads)
    past = open_run(path)
    if len(past) <= 1 and not checkpoint.beside(path).exists():
        raise MeltError(f"{path} was stopped before its first checkpoint (time.checkpoint_every): start the run again, with --overwrite")
    arrays, meta = checkpoint.load(checkpoint.beside(path))
    scene = scene_from_toml(past.scene_text, f"scene of {path}")
    answering = told(scene, on_unstable)  # to alarms; the checkpoint is of the scene as it is in the file
    total = scene.time.steps_to(check_number("until", scene.time.end if until is None else until, at_least=0))
    if total < meta["clock"]["step"]:
        raise MeltError(f"{path} is already at t = {meta['clock']['time']:g} s, later than its end: give a later --until")
    sim = Simulation(scene, backend or meta["backend"], meta["precision"], timed=True, progress=say)
    sim.restore(arrays, meta)
    sim.scene = answering
    writer = RunWriter.resume(path, frames=int(meta["frames"]))
    try:
        say("resume", message=f"continuing at t = {sim.time:.6g} s with frame {int(meta['frames'])}")
        return loop(sim, writer, say, total)
    finally:
        writer.close()
