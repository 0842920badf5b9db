"""Results on the CPU do not depend on the number of threads, bit by bit, and repeat from run to run."""

import os
import subprocess
import sys

from melt.stages import STAGES


def test_cpu_stages_are_bit_identical_for_any_number_of_threads():
    environment = {**os.environ, "MELT_PARALLEL": "1", "NUMBA_NUM_THREADS": "3"}
    command = [sys.executable, "-m", "melt.check.threads"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    lines = dict(line.split(" ", 1) for line in done.stdout.splitlines() if " " in line)
    differing = {stage: fields for stage, fields in lines.items() if fields != "same"}
    assert not differing
    assert done.returncode == 0, done.stderr[-2000:]
    assert set(lines) == set(STAGES)
