"""What tests of runs share: a simulation after some steps, and what a run file holds."""

import h5py

from melt.simulation import Simulation


def stepped(scene, steps, backend="cpu", **options):
    """Return a simulation after some outer steps."""
    sim = Simulation(scene, backend, **options)
    for _ in range(steps):
        sim.step()
    return sim


def datasets(path):
    """All datasets of a run file but wall times."""
    found = {}
    with h5py.File(path) as file:
        def keep(name, item):
            if isinstance(item, h5py.Dataset) and not name.startswith("melt/series/ms/"):
                found[name] = item[()]
        file.visititems(keep)
    return found
