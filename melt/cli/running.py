"""Commands that step: run and resume."""

import contextlib
import os
import pathlib
from typing import Annotated

import typer

from melt.cli import app
from melt.cli.options import (
    PRECISIONS,
    Backend,
    Budget,
    MaxError,
    OnUnstable,
    Overrides,
    Precision,
    Preset,
    Quiet,
    RunPath,
    SceneName,
    Threads,
    known,
)
from melt.cli.progress import RunProgress
from melt.errors import MeltError

Until = Annotated[
    str | None, typer.Option("--until", metavar="TIME", help="End time in place of the scene's ('2 s').")
]


@app.command("run")
def run(
    scene: SceneName,
    output: Annotated[
        pathlib.Path | None, typer.Option("--output", "-o", help="Run file; SCENE.vtkhdf unless given.")
    ] = None,
    override: Overrides = None,
    preset: Preset = None,
    max_error: MaxError = None,
    budget: Budget = None,
    backend: Backend = "auto",
    precision: Precision = None,
    threads: Threads = None,
    until: Until = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", "-f", help="Replace an existing run file.")
    ] = False,
    lockstep: Annotated[
        str | None,
        typer.Option(
            "--lockstep", metavar="BACKEND", help="Run a second backend beside and compare each stage."
        ),
    ] = None,
    on_unstable: OnUnstable = None,
    quiet: Quiet = False,
):
    """Run a scene and write its run file, which ParaView opens as it is."""
    from melt.dial.choose import choose
    from melt.scene import find_scene

    end = _seconds(until)
    known("precision", precision and [precision], PRECISIONS)
    chosen, said = choose(scene, override or (), preset, max_error, budget, end, precision)
    output = output or pathlib.Path(f"{pathlib.Path(scene).stem}.vtkhdf")
    if output.suffix.lower() in (".mp4", ".png", ".jpg", ".ply", ".obj", ".stl", ".pov"):
        raise MeltError(f"run writes a run file, not a {output.suffix}: name it {output.with_suffix('.vtkhdf')}, then `melt render` it")
    with contextlib.suppress(OSError, ValueError):  # no such file yet, or never
        if os.path.samefile(find_scene(scene), output):
            raise MeltError(f"the output {output} is the scene file itself: name another file with --output")
    from melt import simulation

    with RunProgress(quiet) as progress, _nothing_written(progress, output):
        for line in said:
            progress.say(line)
        result = simulation.run(
            chosen,
            output,
            backend=backend,
            precision=precision,
            threads=threads,
            progress=progress,
            overwrite=overwrite,
            lockstep=lockstep,
            until=end,
            on_unstable=on_unstable,
            facts={"chosen": said[0]} if said else None,
        )
    _end(result, progress, output, lockstep)


@app.command("resume")
def resume(
    path: RunPath,
    backend: Annotated[
        str | None, typer.Option("--backend", "-b", help="The run's own unless given.")
    ] = None,
    threads: Threads = None,
    until: Until = None,
    on_unstable: OnUnstable = None,
    quiet: Quiet = False,
):
    """Continue a run from its last checkpoint; on the same backend bit by bit as if it had never stopped."""
    end = _seconds(until)
    from melt import simulation

    with RunProgress(quiet) as progress:
        result = simulation.resume(
            path, backend=backend, threads=threads, progress=progress, until=end, on_unstable=on_unstable
        )
    _end(result, progress, path, None)


@contextlib.contextmanager
def _nothing_written(progress, output):
    """Say so when Ctrl-C or SIGTERM comes before the first frame."""
    try:
        yield
    except KeyboardInterrupt as stop:
        if progress.frames:
            raise
        older = f"; the earlier {output} is untouched" if os.path.lexists(output) else ""
        raise type(stop)(f"stopped before the first frame: nothing was written{older}") from None


def _end(result, progress, output, lockstep):
    """Say what came out of a run; Ctrl-C and SIGTERM give the exit code of an interrupted command."""
    rate = progress.rate()
    progress.say(
        f"{output}: {progress.frames} frames, t = {result.simulation.time:.4g} s, "
        f"{progress.walls(result)}{f', {rate}' if rate else ''}"
    )
    if lockstep:
        for (stage, field), found in sorted(result.simulation.do.worst.items()):
            progress.say(f"  {stage}.{field}: {found.ratio:.3g} of the tolerance")
    if result.interrupted:
        progress.say(f"stopped as asked: the file is whole; continue with melt resume {output}")
        raise typer.Exit(128 + int(result.interrupted))


def _seconds(text):
    if text is None:
        return None
    from melt import units

    return units.duration(text, "--until", zero=True)
