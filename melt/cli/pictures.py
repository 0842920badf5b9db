"""Commands on run files: info, gauges and render."""

import pathlib
import re
from typing import Annotated

import typer

from melt.cli import app
from melt.cli.options import Quiet, RunPath
from melt.errors import MeltError


@app.command("info")
def info(path: RunPath):
    """Say what a run file holds: scene, provenance, frames, fields, ledgers."""
    from melt.output.info import describe

    facts = describe(path)
    width = max(len(name) for name, _ in facts)
    for name, value in facts:
        typer.echo(f"{name:<{width}}  {value}")


@app.command("gauges")
def gauges(
    path: RunPath,
    output: Annotated[pathlib.Path | None, typer.Option("--output", "-o", help="CSV file; standard output unless given.")] = None,
):
    """Write what the gauges of a flood read as CSV: time [s], then surface [m], depth [m] and speed [m/s] of each."""
    from melt.output.gauges import as_csv

    text = as_csv(path)
    if output is None:
        typer.echo(text, nl=False)
        return
    from melt.output.whole import write_whole

    write_whole(output, text.encode())
    typer.echo(f"{output} written", err=True)


@app.command("render")
def render(
    path: RunPath,
    output: Annotated[
        pathlib.Path | None,
        typer.Option(
            "--output", "-o", help="RUN.png unless given; .mp4 gives a video, .ply .obj .vtp .pov a mesh."
        ),
    ] = None,
    frame: Annotated[int, typer.Option("--frame", help="Frame of a picture or mesh; -1 is the last.")] = -1,
    field: Annotated[str, typer.Option("--field", help="Field that the colours show.")] = "temperature",
    surface: Annotated[bool, typer.Option("--surface", help="Draw surfaces in place of particles.")] = False,
    renderer: Annotated[
        str, typer.Option("--renderer", help="particles, or screen: a smooth liquid without a mesh, fast.")
    ] = "particles",
    smooth: Annotated[
        str, typer.Option("--smooth", help="Of --renderer screen: narrow, separable or bilateral.")
    ] = "narrow",
    view: Annotated[
        str, typer.Option("--view", help="Where the camera stands: iso, front, side, top.")
    ] = "iso",
    size: Annotated[str, typer.Option("--size", metavar="WxH", help="Pixels of a picture.")] = "1280x720",
    walls: Annotated[bool, typer.Option("--walls", help="Draw wall particles that the file has.")] = False,
    fps: Annotated[int, typer.Option("--fps", min=1, max=240, help="Frames per second of a video.")] = 25,
    frames: Annotated[
        str | None, typer.Option("--frames", metavar="A:B:STEP", help="Frames of a video, as a Python slice: 10:40, ::2.")
    ] = None,
    quiet: Quiet = False,
):
    """Draw a frame as a picture, all frames as a video, or export the surfaces of a frame."""
    from melt.output.picture import render as draw

    output = output or path.with_suffix(".png")
    options, screen = {}, _screen(renderer, smooth, surface)
    if output.suffix.lower() in (".png", ".mp4"):
        options = dict(field=field, surface=surface, view=view, size=_pixels(size), walls=walls, screen=screen)
    if output.suffix.lower() == ".mp4":
        draw(path, output, fps=fps, frames=_slice(frames), progress=None if quiet else _bar(), **options)
    else:
        draw(path, output, frame, **options)
    if not quiet:
        left_out = output.suffix.lower() in (".ply", ".obj", ".vtp", ".pov") and _has_gas(path)
        typer.echo(f"{output} written" + (", without its bubbles and vapour: pictures and videos have them" if left_out else ""), err=True)


def _screen(renderer, smooth, surface):
    """Return the smoothing of the screen-space renderer, None for the other one."""
    from melt.output.screen import SMOOTH

    for option, given, known in (("--renderer", renderer, ("particles", "screen")), ("--smooth", smooth, SMOOTH)):
        if given not in known:
            raise MeltError(f"{option} {given}: use {', '.join(known)}")
    if renderer == "screen" and surface:
        raise MeltError("--surface draws a mesh and --renderer screen does without: give one of them")
    return smooth if renderer == "screen" else None


def _has_gas(path):
    from melt.output.run_reader import open_run

    run = open_run(path)
    try:
        return "bubble_radius" in run.fields
    finally:
        run.close()


def _slice(text):
    """Return the slice that a text such as 10:40:2 asks for, None for no text."""
    if text is None:
        return None
    if not re.fullmatch(r"-?\d*(:-?\d*){1,2}", text) or text.endswith(":0"):
        raise MeltError(f"--frames {text}: write FIRST:LAST:STEP, each may be left out, for instance 10:40 or ::2")
    return slice(*(int(n) if n else None for n in text.split(":")))


def _pixels(text):
    match = re.fullmatch(r"(\d+)x(\d+)", text.lower())
    if match is None or not all(16 <= int(n) <= 8192 for n in match.groups()):
        raise MeltError(
            f"--size {text}: write WIDTHxHEIGHT in pixels, 16 to 8192 each, for instance 1280x720"
        )
    return int(match[1]), int(match[2])


def _bar():
    """Return a progress callback ``(done, total)``: a bar on a terminal, else a line every ten seconds."""
    import sys
    import time

    if not sys.stderr.isatty():
        began = told = time.monotonic()

        def line(done, total):
            nonlocal told
            now = time.monotonic()
            if now - told >= 10 and done < total:
                told = now
                typer.echo(f"frame {done} of {total}, about {(now - began) / done * (total - done):.0f} s left", err=True)

        return line
    from rich.console import Console
    from rich.progress import Progress

    bar = Progress(console=Console(file=sys.stderr), transient=True)
    task = bar.add_task("drawing")

    def tell(done, total):
        bar.start()
        bar.update(task, completed=done, total=total)
        if done == total:
            bar.stop()

    return tell
