import subprocess
import sys

import h5py
import numpy as np

from melt.output.provenance import commit, provenance
from melt.output.run_file import RunWriter
from melt.output.run_reader import open_run


def test_provenance_travels_with_the_run(tmp_path):
    facts = provenance(backend="cpu", precision="single", threads=2, seed=7)
    assert facts["numpy"] == np.__version__ and facts["h5py"] == h5py.__version__ and facts["numba"]
    assert facts["python"] == ".".join(map(str, sys.version_info[:3]))
    assert (facts["backend"], facts["precision"], facts["threads"], facts["seed"]) == ("cpu", "single", 2, 7)
    assert facts["melt"] and facts["processor"] and facts["machine"] and facts["command"] and facts["started"]
    RunWriter(tmp_path / "a.vtkhdf", "", facts).close()
    assert open_run(tmp_path / "a.vtkhdf").provenance == facts


def test_commit_of_a_checkout(tmp_path):
    def git(*words):
        done = subprocess.run(
            ["git", "-C", str(tmp_path), *words], capture_output=True, text=True, check=True
        )
        return done.stdout.strip()

    (tmp_path / "melt" / "output").mkdir(parents=True)
    file = tmp_path / "melt" / "output" / "provenance.py"
    file.write_text("1")
    assert commit(tmp_path / "melt") == {}
    git("init")
    assert commit(tmp_path / "melt") == {}  # somebody else's checkout: the file is not tracked
    git("add", ".")
    git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "-m", "one")
    assert commit(tmp_path / "melt") == {"commit": git("rev-parse", "HEAD"), "dirty": 0}
    file.write_text("2")
    assert commit(tmp_path / "melt")["dirty"] == 1
