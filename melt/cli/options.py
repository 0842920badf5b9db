"""Options that several commands share."""

import pathlib
from typing import Annotated

import typer

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
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors only.")]
