"""Commands on run files: info and render."""


import typer

from melt.cli import app
from melt.cli.options import RunPath


@app.command("info")
def info(path: RunPath):
    """Say what a run file holds: scene, provenance, frames, fields, ledgers."""
    from melt.output.info import describe

    typer.echo(describe(path))
