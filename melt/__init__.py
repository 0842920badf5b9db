"""melt: particle fluids that change state and shape.

The public API: ``load_scene``, ``Simulation`` (step by hand), ``simulate`` (run to a file), ``open_run``.
Names are imported on first use, so that ``import melt`` compiles and reads nothing.
"""

__version__ = "0.1.0"
__all__ = ["Simulation", "load_scene", "open_run", "simulate"]


def load_scene(name, overrides=(), preset=None):
    """Return a validated scene by shipped name or path; see `melt.scene.load_scene`."""
    from melt.scene import load_scene as load

    return load(name, overrides, preset)


def simulate(scene, output=None, **options):
    """Run a scene and write its run file; see `melt.simulation.run`."""
    from melt.simulation import run

    return run(scene, output, **options)


def open_run(path):
    """Open a run file; see `melt.output.run_reader.open_run`."""
    from melt.output.run_reader import open_run as open_

    return open_(path)


def __getattr__(name):
    if name == "Simulation":
        from melt.simulation import Simulation

        return Simulation
    raise AttributeError(f"module 'melt' has no attribute {name!r}")
