"""The part of the checks that runs where ``NUMBA_ENABLE_CUDASIM=1``: see `melt.check.report` and `melt.check.replay`."""

import json
import sys

from melt import _compile
from melt.check import replay, report


def main(job):
    """Check the stages of ``job`` (JSON), or replay its capsule, on the simulator and write what comes to its ``out``."""
    if not _compile.SIMULATED:
        raise SystemExit("start this with NUMBA_ENABLE_CUDASIM=1 in the environment")
    if _compile.CUDA_MISSING:
        raise SystemExit(_compile.CUDA_MISSING)
    job = json.loads(job)
    if "capsule" in job:
        return replay.simulate(job["capsule"], job["out"])
    rows = []
    for stage in job["stages"]:
        for precision in job["precisions"]:
            rows += report.check_stage(stage, precision, ("cuda-simulated",), job["n"], job["seed"])
    with open(job["out"], "w") as file:
        json.dump([row._asdict() for row in rows], file)


if __name__ == "__main__":
    main(sys.argv[1])
