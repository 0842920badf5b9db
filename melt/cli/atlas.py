"""The command atlas: where a scene is stable, two knobs at a time."""

import pathlib
from typing import Annotated

import typer

from melt.cli import app
from melt.cli.options import Overrides, SceneName, Threads


@app.command("atlas")
def atlas(
    scene: SceneName,
    maps: Annotated[
        list[str] | None, typer.Option("--map", metavar="NAME", help="Map to sweep (repeat); all that apply unless given.")
    ] = None,
    listed: Annotated[bool, typer.Option("--list", help="Print the maps of the scene, and sweep nothing.")] = False,
    rows: Annotated[int | None, typer.Option("--cells", min=1, max=64, help="Rows of a map: values of its second knob.")] = None,
    steps: Annotated[int | None, typer.Option("--steps", min=1, help="Steps of a run at most.")] = None,
    out: Annotated[
        pathlib.Path | None, typer.Option("--output", "-o", help="HDF5 file; SCENE_atlas.h5 unless given. The plot goes beside it.")
    ] = None,
    override: Overrides = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", "-f", help="Replace an existing file.")] = False,
    threads: Threads = None,
):
    """Measure where a scene is stable: two knobs at a time, beside the bound that its plan predicts."""
    from melt import backend
    from melt.atlas import maps as known
    from melt.atlas import sweep
    from melt.scene import load_scene

    if listed:
        for m in known.chosen(load_scene(scene, override or ()), maps):
            typer.echo(f"{m.name:<28}{m.words} x {m.along.words}; predicted: {m.predicted}")
        return
    backend.set_threads(threads)
    out = out or pathlib.Path(f"{pathlib.Path(scene).stem}_atlas.h5")
    sweep.run(scene, out, maps, override or (), rows, steps, overwrite, say=typer.echo)
