"""One run of a study: curves, cost, and the reference run, which is made once and kept."""

import contextlib
import hashlib
import io
import json
import os
import pathlib
import time
import zipfile
from typing import NamedTuple

import numpy as np

from melt._compile import KEPT_DAYS, cache_root
from melt.dial.systems import curves_of
from melt.errors import MeltError
from melt.geometry.build import build
from melt.output.errors import OutputError
from melt.output.whole import write_whole
from melt.physics.phases import LIQUID
from melt.simulation import Simulation

WARM = 2  # steps that are not timed: buffers grow in them, and what is left to compile compiles
SHAKE = 1e-3  # of a spacing, by which repetitions differ: seeds alone say nothing where nothing random happens in a run
#: Folders of melt, and files of this one, that no figure of a study on the CPU depends on.
APART = ("cli", "check", "cuda", "reference", "output")
SAYING = ("report.py", "choose.py")


class TooSlow(MeltError):
    """A run took much longer than was forecast: it is given up."""


class Sample(NamedTuple):
    """What one run gave: curves over time, and what it cost."""

    times: np.ndarray
    curves: dict
    ms_per_step: float  # median over outer steps
    s_per_simulated_s: float
    bytes: int
    n_sub: int
    seconds: float  # wall time of its steps and of building it, compiling apart

    @property
    def truth(self):
        """What errors are taken against."""
        return self.times, self.curves


def sample(scene, window, shaken=0, patience=np.inf):
    """Run a scene for ``window`` simulated seconds and return its `Sample`.

    ``shaken``: number of the repetition by which liquid particles are displaced, 0 for none.

    Raises:
        MeltError: it is not stable.
        TooSlow: its steps take longer than ``patience`` [s].
    """
    began = time.perf_counter()
    initial = build(scene)
    if shaken:
        shake(initial, scene, shaken)
    sim = Simulation(scene, "cpu", initial=initial)
    seconds = time.perf_counter() - began - sim.compile_seconds
    times, curves, spent = [], [], []
    for _ in range(max(1, round(window / scene.time.dt))):
        began = time.perf_counter()
        sim.step()
        spent.append(time.perf_counter() - began)
        times.append(sim.time)
        curves.append(curves_of(sim))
        if sum(spent) > patience:
            raise TooSlow(f"more than {patience:.0f} s for {window:g} simulated seconds: given up")
    stacked = {name: np.array([c.get(name, np.nan) for c in curves]) for name in curves[0]}
    typical = float(np.median(spent[min(WARM, len(spent) - 1):]))
    n_sub = int(sim.series().get("n_sub", 0))
    return Sample(np.array(times), stacked, 1e3 * typical, typical / scene.time.dt, sim.prepared.nbytes, n_sub, seconds + sum(spent))


def shake(initial, scene, number):
    """Displace the liquid by `SHAKE` of a spacing at most, in the directions in which it extends; the same for every run."""
    x = initial.arrays["position"]
    liquid = initial["phase"] == LIQUID
    shift = np.random.default_rng(number).uniform(-1, 1, (x.shape[0], int(liquid.sum()))) * SHAKE * initial.spacing
    if liquid.any():  # a flood may begin dry
        shift[np.ptp(x[:, liquid], axis=1) == 0] = 0.0
    x[:, liquid] += shift


def source_hash():
    """Return a short hash of the sources that the figures of a study depend on."""
    root = pathlib.Path(__file__).resolve().parent.parent
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        folder, name = path.relative_to(root).parts[0], path.name
        if folder not in APART and not (folder == "dial" and name in SAYING):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def reference_run(load, overrides, window, folder=None):
    """Return (`Sample` of the reference run, whether it was kept from an earlier study).

    It is kept in ``folder`` (beside the compiled code unless given), named by the scene, the window and the source.

    Args:
        load: (overrides) -> Scene.
    """
    scene = load(overrides)
    folder = pathlib.Path(folder) if folder else cache_root() / "references"
    key = json.dumps([scene.to_toml(), window, source_hash()])
    path = folder / f"{hashlib.sha256(key.encode()).hexdigest()[:24]}.npz"
    with contextlib.suppress(OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):  # not there, or not whole: it is made again
        with np.load(path) as kept:
            curves = {name[2:]: kept[name] for name in kept.files if name.startswith("c:")}
            rest = [kept[name].item() for name in Sample._fields[2:]]
            os.utime(path)
            return Sample(kept["times"], curves, *rest), True
    made = sample(scene, window)
    _keep(made, path)
    return made, False


def _keep(made, path):
    """Write a sample whole or not at all; a cache that cannot be written is done without. Those of last month go."""
    values = {"times": made.times, **{f"c:{name}": curve for name, curve in made.curves.items()}}
    values |= {name: np.array(getattr(made, name)) for name in Sample._fields[2:]}
    packed = io.BytesIO()
    np.savez(packed, **values)
    with contextlib.suppress(OSError, OutputError):
        path.parent.mkdir(parents=True, exist_ok=True)
        for other in path.parent.glob("*.npz"):
            if other.stat().st_mtime < time.time() - KEPT_DAYS * 86400:
                other.unlink()
        write_whole(path, packed.getvalue())
