"""Progress of a run on a terminal: share done, time left, particles per second."""

import sys
import time

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

DELAY = 2.0  # seconds before a bar appears


class RunProgress:
    """Callback of `melt.simulation`: ``progress(event, **values)``. Use it as a context manager.

    Warnings and the backend are said always (unless ``quiet``), the bar only where stderr is a terminal:
    a first sub-step that compiles, then share done, time left and particle sub-steps per second.
    """

    def __init__(self, quiet=False, stream=None):
        self.stream = stream or sys.stderr
        self.quiet = quiet
        self.shown = not quiet and self.stream.isatty()
        self.frames = self.particles = self.step = self.steps = 0
        self.time = 0.0
        self._work = 0  # particles times sub-steps since the first step ended
        self._stepping = None  # wall time when the first step, which compiles, ended
        self._began = time.perf_counter()
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

    def _on_compile(self, message, **_):
        if self.shown:
            self._bar.start()  # at once: nothing else tells why nothing happens
            self._bar.update(self._task, description=message)

    def _on_warning(self, message, **_):
        self.say(f"note: {message}")

    def _on_resume(self, message, **_):
        self.say(message)

    def _on_start(self, message, steps=0, step=0, particles=0, simulation=None, **_):
        self.steps, self.step, self.particles = steps, step, particles
        if simulation is not None:
            backend = simulation.backend
            self.say(f"backend {backend.name} ({backend.reason}), {simulation.prepared.precision} precision")
            self.say(f"{particles:,} particles, {steps - step:,} steps of {simulation.scene.time.dt:g} s")
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

    def _on_frame(self, message, frames=0, **_):
        self.frames = frames

    def rate(self, now=None):
        """Return millions of particle sub-steps per second since the first step, in words."""
        if self._stepping is None or not self._work:
            return ""
        seconds = (_now() if now is None else now) - self._stepping
        return f"{self._work / max(seconds, 1e-9) / 1e6:.3g} M particle sub-steps/s"


def _now():
    return time.perf_counter()
