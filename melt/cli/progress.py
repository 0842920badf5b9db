"""Progress of a run: a bar on a terminal, plain lines elsewhere."""

import os
import sys
import time

import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

from melt.physics.phases import PHASE_NAMES

DELAY = 2.0  # seconds before a bar appears
EVERY = 10.0  # seconds between plain lines at most
SOONEST = 1.0  # seconds between plain lines at least, with a tenth of the steps between them


class RunProgress:
    """Callback of `melt.simulation`: ``progress(event, **values)``. Use it as a context manager.

    Warnings, the backend and what runs are said always (unless ``quiet``). Where stderr is a terminal a bar
    shows share done, time left and particle sub-steps per second; elsewhere a line every 10 s or
    every tenth of the steps says the same.
    """

    def __init__(self, quiet=False, stream=None):
        self.stream = stream or sys.stderr
        self.quiet = quiet
        self.shown = not quiet and self.stream.isatty()
        self.frames = self.particles = self.step = self.steps = 0
        self.time = 0.0
        self._work = 0  # particles times sub-steps since the first step ended
        self._first = 0  # number of the first step, which may compile
        self._stepping = None  # wall time when the first step ended
        self._compiling = False
        self._told = (0.0, 0)  # wall time and step of the last plain line
        self._began = self._started = time.perf_counter()
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TaskProgressColumn(),
            TimeRemainingColumn(),
            TextColumn("{task.fields[rate]}"),
            console=Console(file=self.stream),
            transient=True,
        )
        self._task = self._bar.add_task("preparing", total=None, rate="")

    def __enter__(self):
        return self

    def __exit__(self, *error):
        if self._bar.live.is_started:
            self._bar.stop()

    def __call__(self, event, message="", **values):
        """Take news of the run."""
        handler = getattr(self, f"_on_{event}", None)
        if handler is not None:
            handler(message, **values)

    def say(self, text):
        """Print a line above the bar."""
        if self.quiet:
            return
        if self.shown:
            self._bar.console.print(text, highlight=False, markup=False)
        else:
            typer.echo(text, file=self.stream)

    def _on_compile(self, message, done=0, total=None, **_):
        if self.shown:
            self._bar.start()  # at once: nothing else tells why nothing happens
            self._bar.update(self._task, description=message, completed=done, total=total)
        elif not self._compiling:
            self.say(f"{message}: {total} of them, about {max(1, round(1.3 * total / (os.cpu_count() or 1)))} s" if total else message)
            self._told = (_now(), 0)
        elif _now() - self._told[0] >= EVERY:
            self.say(f"{message}: {done} of {total} done")
            self._told = (_now(), 0)
        self._compiling = True

    def _on_warning(self, message, **_):
        self.say(f"note: {message}")

    def _on_unstable(self, message, **_):
        self.say(f"note: {message}".replace("\n", "\n      "))

    def _on_written(self, message, **_):
        self.say(message)

    def _on_resume(self, message, **_):
        self.say(message)

    def _on_start(self, message, steps=0, step=0, particles=0, simulation=None, **_):
        self.steps, self.step, self.particles, self._first = steps, step, particles, step + 1
        self._started = _now()
        self._told = (self._started, step)
        if simulation is not None:
            backend, dt = simulation.backend, simulation.scene.time.dt
            self.say(f"backend {backend.name} ({backend.reason}), {simulation.prepared.precision} precision")
            self.say(f"{_counts(simulation)} particles, {steps - step:,} steps of {dt:g} s{_expected(simulation, steps - step)}")
        if self.shown:
            text = "first step (compiles what is not cached)"
            self._bar.update(self._task, description=text, total=steps, completed=step)

    def _on_step(self, message, step=0, time=0.0, n_sub=0, particles=None, **_):
        self.step, self.time = step, time
        self.particles = particles or self.particles
        now = _now()
        if self._stepping is None:
            self._stepping = now
        else:
            self._work += self.particles * max(1, n_sub)
        if self.shown:
            if not self._bar.live.is_started and now - self._began > DELAY:
                self._bar.start()
            text = f"t = {time:.4g} s"
            self._bar.update(
                self._task, description=text, completed=step, total=self.steps, rate=self.rate(now)
            )
        elif self._due(now):
            self._told = (now, step)
            left = (self.steps - step) * (now - self._stepping) / max(1, step - self._first)
            left = f"about {left:,.0f} s left" if step > self._first else "time left not known yet"
            self.say(f"step {step:,} of {self.steps:,} ({step / max(1, self.steps):.0%}), t = {time:.4g} s, {left}")

    def _due(self, now):
        """Return whether a plain line is due; the last step has the closing line."""
        if self.step >= self.steps:
            return False
        waited, tenth = now - self._told[0], max(1.0, self.steps / 10)
        crossed = self.step // tenth > self._told[1] // tenth
        return waited >= EVERY or (crossed and waited >= SOONEST)

    def _on_frame(self, message, frames=0, **_):
        self.frames = frames

    def rate(self, now=None):
        """Return millions of particle sub-steps per second since the first step, in words."""
        if self._stepping is None or not self._work:
            return ""
        seconds = (_now() if now is None else now) - self._stepping
        return f"{self._work / max(seconds, 1e-9) / 1e6:.3g} M particle sub-steps/s"

    def walls(self, result):
        """Return the wall time of a run in words: compiling and stepping apart."""
        simulation, stepped = result.simulation, result.seconds
        compiled = simulation.compile_seconds
        if simulation.backend.folder == "cuda" and self._stepping is not None:  # kernels compile as they are met
            first = self._stepping - self._started
            return f"first step, which compiles, {first:.1f} s, the others {max(0.0, stepped - first):.1f} s"
        return f"compiled {compiled:.1f} s, stepped {stepped:.1f} s"


def _counts(simulation):
    """Return how many particles of each kind there are, in words."""
    number = np.bincount(simulation.read("phase"), minlength=len(PHASE_NAMES))
    waiting = "slots for bubbles and vapour" if simulation.scene.boiling is not None else "still to flow in"
    if simulation.scene.kind == "flood":
        waiting = "free (for water that enters)"
    names = [name if name != "inactive" else waiting for name in PHASE_NAMES]
    return " + ".join(f"{n:,} {name}" for n, name in zip(number, names) if n) or "0"


def _expected(simulation, steps):
    """Return the forecast of a run on CPU in words."""
    from melt.forecast import forecast

    if simulation.backend.name != "cpu" or steps <= 0:
        return ""
    return f"; {forecast(simulation.scene, simulation.initial, simulation.prepared, steps).text}"


def _now():
    return time.perf_counter()
