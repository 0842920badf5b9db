"""The dam break of `boiling_pbf_bench` in SPlisHSPlasH: ``python _splish.py EDGE SPACING DT ITERATIONS WARM STEPS THREADS``.

Stands on its own: it runs in a process of its own, because importing the package can end the process, and perhaps in
another environment than melt's. Prints one line of JSON behind ``RESULT``.
"""

import contextlib
import ctypes
import json
import os
import pathlib
import sys
import tempfile
import time

BOX = """v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1
f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n"""


def scene(edge, spacing, dt, iterations):
    """Return the scene: a cube of edge^3 particles at one end of a box 1.5 times as long, z up.

    Walls are one layer of particles 1.2 spacings from the liquid's first: at one spacing the liquid beside them is 19 %
    too dense, and the column bursts in the first step.
    """
    size, half, gap = edge * spacing, spacing / 2, 0.7 * spacing
    return {
        "Configuration": {
            "particleRadius": half, "simulationMethod": 2, "boundaryHandlingMethod": 0, "timeStepSize": dt,
            "cflMethod": 0, "gravitation": [0, 0, -9.81], "numberOfStepsPerRenderUpdate": 1, "enableZSort": True,
            "dataExportFPS": 0,
        },
        "Fluid": {"density0": 1000, "viscosityMethod": 0},
        "RigidBodies": [{
            "geometryFile": "box.obj", "translation": [-gap] * 3, "rotationAxis": [1, 0, 0], "rotationAngle": 0,
            "scale": [1.5 * size + 2 * gap, size + 2 * gap, size + 2 * gap], "isDynamic": False, "isWall": True, "color": [0, 0, 0, 0],
        }],
        "FluidBlocks": [{"denseMode": 0, "start": [-half] * 3, "end": [size + half] * 3, "translation": [0, 0, 0], "scale": [1, 1, 1]}],
    }


def main(edge, spacing, dt, iterations, warm, steps):
    # the wheel brings a libGLdispatch of its own, and the system's libGL must not find it first
    with contextlib.suppress(OSError):
        ctypes.CDLL("libGL.so.1", mode=ctypes.RTLD_GLOBAL)
    import pysplishsplash as splish

    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "box.obj").write_text(BOX)
        (folder / "dam.json").write_text(json.dumps(scene(edge, spacing, dt, iterations)))
        base = splish.Exec.SimulatorBase()
        base.init(
            sceneFile=str(folder / "dam.json"), useGui=False, initialPause=False, useCache=False,
            outputDir=str(folder / "out"), stopAt=10 * (warm + steps) * dt,
        )
        base.initSimulation()
        sim = splish.Simulation.getCurrent()
        step = sim.getTimeStep()
        step.setValueUInt(step.MIN_ITERATIONS, iterations)
        step.setValueUInt(step.MAX_ITERATIONS, iterations)
        ends = [time.perf_counter()]

        def after_step():
            ends.append(time.perf_counter())
            assert step.getNumIterations() == iterations, step.getNumIterations()
            if len(ends) == warm + steps + 1:
                walls = sorted(1e3 * (b - a) for a, b in zip(ends[warm:], ends[warm + 1 :]))
                print("RESULT " + json.dumps(figures(splish, sim, spacing, walls)), flush=True)
                os._exit(0)  # its clean-up needs a window

        base.setTimeStepCB(after_step)
        base.runSimulation()


def figures(splish, sim, spacing, walls):
    """Return what is compared: median and best ms per step, sizes, neighbours (walls among them), support in spacings."""
    fluid = sim.getFluidModel(0)
    n, sets = fluid.numActiveParticles(), range(sim.numberOfPointSets())
    return {
        "step_ms": walls[len(walls) // 2], "step_ms_best": walls[0], "liquid": n,
        "wall": sim.getBoundaryModel(0).numberOfParticles(),
        "neighbours": sum(sim.numberOfNeighbors(0, other, i) for i in range(n) for other in sets) / n,
        "support": sim.getSupportRadius() / spacing, "dt": splish.TimeManager.getCurrent().getTimeStepSize(),
        "front": sorted(float(fluid.getPosition(i)[0]) for i in range(n))[int(0.98 * n)], "method": sim.getValueInt(sim.SIMULATION_METHOD),
    }


if __name__ == "__main__":
    edge, spacing, dt, iterations, warm, steps, threads = sys.argv[1:]
    os.environ["OMP_NUM_THREADS"] = threads
    main(int(edge), float(spacing), float(dt), int(iterations), int(warm), int(steps))
