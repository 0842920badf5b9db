"""The command line: parse, call the library, print. Each command imports what it needs when it runs."""

import os
import sys
import traceback

import typer
from rich.console import Console
from typer.core import TyperGroup

from melt.errors import MeltError
from melt.interrupt import Terminated, terminable

#: Exit codes: 1 an error the user can mend, 2 wrong usage, 3 a check found differences, 70 a fault of melt,
#: 130 stopped by Ctrl-C, 143 by SIGTERM (128 + the signal).
FAILED, DIFFERENT, INTERNAL, INTERRUPTED, TERMINATED = 1, 3, 70, 130, 143


class Melt(TyperGroup):
    """Commands whose errors are one paragraph, an alarm's lines below each other; with the traceback on ``--debug`` (anywhere)."""

    def parse_args(self, ctx, args):
        """Take ``--debug`` out of the arguments, wherever it stands."""
        ctx.meta["debug"] = "--debug" in args
        return super().parse_args(ctx, [a for a in args if a != "--debug"])

    def invoke(self, ctx):
        """Run the command; turn errors into a message and an exit code."""
        try:
            with terminable():
                return super().invoke(ctx)
        except (typer.Exit, typer.Abort):
            raise
        except BrokenPipeError:  # the reader (head, less) has enough
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or the last flush would complain
            raise typer.Exit(0) from None
        except KeyboardInterrupt as error:
            code = TERMINATED if isinstance(error, Terminated) else INTERRUPTED
            text, trace = str(error) or "stopped; files hold all completed frames", ""
        except Exception as error:
            if _is_usage(error):
                raise
            code, text, trace = FAILED, "\n      ".join(getattr(error, "lines", [str(error)])), traceback.format_exc()
            if not isinstance(error, MeltError):
                code = INTERNAL
                text = (
                    f"internal error, {type(error).__name__}: {error}. A fault of melt; --debug shows where"
                )
        typer.echo(f"{trace if ctx.meta['debug'] else ''}melt: {text}", err=True)
        raise typer.Exit(code)


def _is_usage(error):
    """Return whether click itself reports ``error`` (wrong option, missing argument)."""
    return hasattr(error, "exit_code") and hasattr(error, "show")


app = typer.Typer(
    cls=Melt,
    name="melt",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Particle fluids that change state and shape, on CPU and GPU.",
)


@app.callback()
def _options(debug: bool = typer.Option(False, "--debug", help="Show tracebacks of errors.")):
    """Take the options that all commands share."""


def console():
    """Return the console for results (stdout; plain text, lines never cut or folded, when it is not a terminal)."""
    return Console(file=sys.stdout, width=None if sys.stdout.isatty() else 10_000, highlight=False)


def main():
    """Entry point of the command ``melt``."""
    app(prog_name="melt")


from melt.cli import running, scenes, pictures, measure, atlas  # noqa: E402, F401, I001  (they add their commands, in this order)
