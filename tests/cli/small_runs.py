"""A small scene, the command line run in this process, and what a refusal looks like."""

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


def melt(*words):
    """Run a command in this process."""
    return CliRunner().invoke(app, [str(w) for w in words], prog_name="melt")


def refused(result, *said):
    """Hold that a command failed with exit code 1 and one paragraph that says all of ``said``."""
    assert result.exit_code == FAILED, result.output
    last = result.stderr.strip().splitlines()[-1]
    assert last.startswith("melt: "), result.stderr
    assert all(line.startswith(("note: ", "backend ", "continuing ", "melt: ")) or " particles, " in line
               for line in result.stderr.strip().splitlines()), result.stderr  # fmt: skip
    for words in said:
        assert words in last, last
    assert "Traceback" not in result.output and "internal error" not in result.output


def frames(path):
    """Return the number of frames in a run file, 0 where it is not laid out yet."""
    try:
        with h5py.File(path) as file:
            return file["VTKHDF/Steps/Values"].shape[0]
    except (OSError, KeyError):
        return 0
