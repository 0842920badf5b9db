"""Commands about scenes: scenes, plan, schema, show."""

import json
from typing import Annotated

import typer
from rich.table import Table

from melt.cli import app, console
from melt.cli.options import PRECISIONS, Budget, MaxError, Overrides, Precision, Preset, SceneName, known


@app.command("scenes")
def scenes(
    names: Annotated[bool, typer.Option("--names", help="Print the names only, one per line.")] = False,
):
    """List the shipped scenes and what each stands for."""
    from melt.scene import load_scene, shipped_scenes

    shipped = shipped_scenes()
    if names:
        typer.echo("\n".join(shipped))
        return
    table = Table("scene", "stands for", "what happens", box=None, pad_edge=False)
    for name in shipped:
        about = load_scene(name).scene
        table.add_row(name, about.figure, about.description)
    console().print(table)


@app.command("plan")
def plan(
    scene: SceneName,
    override: Overrides = None,
    preset: Preset = None,
    precision: Precision = None,
    max_error: MaxError = None,
    budget: Budget = None,
):
    """Say what a run would do: stages, fields, memory, time steps, and findings with their fixes."""
    from melt.dial.choose import choose
    from melt.preflight import plan as make_plan

    known("precision", precision and [precision], PRECISIONS)
    chosen, said = choose(scene, override or (), preset, max_error, budget, precision=precision)
    for line in (*said, *make_plan(chosen, precision=precision).lines()):
        typer.echo(line)


@app.command("schema")
def schema():
    """Print the JSON Schema of scene files: liquids in a box, or floods (those with a [terrain])."""
    from melt.scene.schema import scene_schema

    typer.echo(json.dumps(scene_schema(), indent=2))


@app.command("show")
def show(scene: SceneName, override: Overrides = None, preset: Preset = None):
    """Print a scene as TOML with every value that is in force."""
    from melt.scene import load_scene

    typer.echo(load_scene(scene, override or (), preset).to_toml(), nl=False)
