"""Options that several commands share."""

import difflib
import pathlib
from typing import Annotated

import typer

from melt.errors import MeltError

PRECISIONS = ("single", "mixed", "double")
BACKENDS = "auto, cpu, cuda, cuda-emulated, cuda-simulated or reference"

SceneName = Annotated[
    str, typer.Argument(metavar="SCENE", help="Name of a shipped scene, or path of a .toml file.")
]
RunPath = Annotated[pathlib.Path, typer.Argument(metavar="RUN", help="Run file (.vtkhdf).")]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Override a scene value (repeat as needed)."),
]
Preset = Annotated[
    str | None,
    typer.Option("--preset", help="draft, balanced, accurate (measured), default, paper, physical, or one of the scene's own."),
]
MaxError = Annotated[
    str | None, typer.Option("--max-error", metavar="SHARE", help="Cheapest measured point within this error ('2%').")
]
Budget = Annotated[
    str | None, typer.Option("--budget", metavar="TIME", help="Most accurate measured point whose forecast fits ('60 s').")
]
Backend = Annotated[str, typer.Option("--backend", "-b", help=BACKENDS + ".")]
Precision = Annotated[
    str | None, typer.Option("--precision", help="single, mixed or double; the scene's unless given.")
]
Threads = Annotated[int | None, typer.Option("--threads", min=1, help="CPU threads; all cores unless given.")]
OnUnstable = Annotated[
    str | None,
    typer.Option("--on-unstable", metavar="stop|halve", help="On an alarm stop, or go back and on with half the step."),
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors only.")]


def known(kind, given, names):
    """Raise `MeltError` for the first name that is not one of ``names``; close ones, or all, are told."""
    for name in given or ():
        if name not in names:
            close = difflib.get_close_matches(name, names, 3)
            hint = f"did you mean {', '.join(close)}?" if close else f"known: {', '.join(names)}"
            raise MeltError(f"unknown {kind} {name!r}; {hint}")
