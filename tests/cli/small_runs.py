"""A small scene, the command line run in this process, and what a refusal looks like."""

import re

import h5py
from typer.testing import CliRunner

from melt.cli import FAILED, app

SCENE = """
[scene]
name = "drop"
[time]
end = 0.05
output_every = 0.01
[domain]
upper = [0.8, 0.8, 1.2]
[[fluid.fill]]
lower = [0, 0, 0]
upper = [0.8, 0.8, 0.8]
"""


#: What a run says that takes its time.
PROGRESS = re.compile(
    r"step [\d,]+ of [\d,]+ \(\d+%\), t = \S+ s, (about [\d,]+ s left|time left not known yet)"
    r"|compiling .*: \d+ of (them, about \d+ s|\d+ done)"
)


def melt(*words):
    """Run a command in this process."""
    return CliRunner().invoke(app, [str(w) for w in words], prog_name="melt")


def refused(result, *said):
    """Hold that a command failed with exit code 1 and one paragraph that says all of ``said``."""
    _failed(result, result.stderr.strip().splitlines(), said)


def alarmed(result, *said):
    """Hold that a run ended with exit code 1 and an alarm that says each of ``said`` on a line further down; return the lines."""
    before, _, alarm = result.stderr.strip().rpartition("\nmelt: ")
    lines = alarm.removeprefix("melt: ").split(f"\n{' ' * 6}")
    assert 3 <= len(lines) <= 6 and not any("\n" in line or line != line.strip() or line[-1] != "." for line in lines), result.stderr
    found = [k for words in said for k, line in enumerate(lines) if words in line]
    assert len(found) == len(said) and found == sorted(set(found)), result.stderr
    _failed(result, [*before.splitlines(), f"melt: {' '.join(lines)}"], said)
    return lines


def _failed(result, lines, said):
    assert result.exit_code == FAILED, result.output
    assert lines[-1].startswith("melt: "), result.stderr
    assert all(line.startswith(("note: ", "backend ", "continuing ", "melt: ")) or " particles, " in line or PROGRESS.fullmatch(line)
               for line in lines), result.stderr  # fmt: skip
    for words in said:
        assert words in lines[-1], lines[-1]
    assert "Traceback" not in result.output and "internal error" not in result.output


def frames(path):
    """Return the number of frames in a run file, 0 where it is not laid out yet."""
    try:
        with h5py.File(path) as file:
            return file["VTKHDF/Steps/Values"].shape[0]
    except (OSError, KeyError):
        return 0
