"""A dam break in SPlisHSPlasH: ``python _splish.py EDGE SPACING DT ITERATIONS WARM STEPS THREADS [METHOD]``.

METHOD is pbf (of `boiling_pbf_bench`, the default), dfsph or weiler (of `slime_bench`; weiler: with the implicit viscosity of
Weiler et al. 2018). ITERATIONS counts for pbf alone: DFSPH iterates to melt's tolerances.

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


#: Box in edges of the cube, SPlisHSPlasH's number of the solver and of the viscosity (standard, Weiler 2018).
METHODS = {"pbf": ((1.5, 1, 1), 2, 0), "dfsph": ((2, 1, 1.5), 4, 0), "weiler": ((2, 1, 1.5), 4, 6)}
VISCOSITY = 50.0  # Pa s; the package asks for the kinematic one


def scene(edge, spacing, dt, method):
    """Return the scene: a cube of edge^3 particles at one end of a box, z up.

    Walls are one layer of particles 1.2 spacings from the liquid's first: at one spacing the liquid beside them is 19 %
    too dense, and the column bursts in the first step.
    """
    size, half, gap = edge * spacing, spacing / 2, 0.7 * spacing
    box, solver, viscosity = METHODS[method]
    return {
        "Configuration": {
            "particleRadius": half, "simulationMethod": solver, "boundaryHandlingMethod": 0, "timeStepSize": dt,
            "cflMethod": 0, "gravitation": [0, 0, -9.81], "numberOfStepsPerRenderUpdate": 1, "enableZSort": True,
            "dataExportFPS": 0,
            "DFSPH": {"minIterations": 2, "maxIterations": 100, "maxError": 0.01, "maxErrorV": 0.1, "enableDivergenceSolver": True},
        },
        "Materials": [{
            "id": "Fluid", "density0": 1000, "viscosityMethod": viscosity,
            "Weiler et al. 2018": {
                "viscosity": VISCOSITY / 1000, "viscosityBoundary": VISCOSITY / 1000, "viscoMaxIter": 200, "viscoMaxError": 1e-3,
            },
        }],
        "RigidBodies": [{
            "geometryFile": "box.obj", "translation": [-gap] * 3, "rotationAxis": [1, 0, 0], "rotationAngle": 0,
            "scale": [b * size + 2 * gap for b in box], "isDynamic": False, "isWall": True, "color": [0, 0, 0, 0],
        }],
        "FluidBlocks": [{"denseMode": 0, "start": [-half] * 3, "end": [size + half] * 3, "translation": [0, 0, 0], "scale": [1, 1, 1]}],
    }


def main(edge, spacing, dt, iterations, warm, steps, method="pbf"):
    # the wheel brings a libGLdispatch of its own, and the system's libGL must not find it first
    with contextlib.suppress(OSError):
        ctypes.CDLL("libGL.so.1", mode=ctypes.RTLD_GLOBAL)
    import pysplishsplash as splish

    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "box.obj").write_text(BOX)
        (folder / "dam.json").write_text(json.dumps(scene(edge, spacing, dt, method)))
        base = splish.Exec.SimulatorBase()
        base.init(
            sceneFile=str(folder / "dam.json"), useGui=False, initialPause=False, useCache=False,
            outputDir=str(folder / "out"), stopAt=10 * (warm + steps) * dt,
        )
        base.initSimulation()
        sim = splish.Simulation.getCurrent()
        step = sim.getTimeStep()
        if method == "pbf":
            step.setValueUInt(step.MIN_ITERATIONS, iterations)
            step.setValueUInt(step.MAX_ITERATIONS, iterations)
        ends, counts = [time.perf_counter()], []

        def after_step():
            ends.append(time.perf_counter())
            assert method != "pbf" or step.getNumIterations() == iterations, step.getNumIterations()
            counts.append(iterations_of(sim, step, method))
            if len(ends) == warm + steps + 1:
                walls = sorted(1e3 * (b - a) for a, b in zip(ends[warm:], ends[warm + 1 :]))
                found = figures(splish, sim, spacing, walls)
                for k, name in enumerate(("pressure_iterations", "divergence_iterations", "viscous_iterations")):
                    found[name] = sorted(c[k] for c in counts[warm:])[steps // 2]
                print("RESULT " + json.dumps(found), flush=True)
                os._exit(0)  # its clean-up needs a window

        base.setTimeStepCB(after_step)
        base.runSimulation()


def iterations_of(sim, step, method):
    """Return iterations of the pressure solve, of the divergence solve and of viscosity in the last step."""
    if method == "pbf":
        return step.getNumIterations(), 0, 0
    viscosity = sim.getFluidModel(0).getViscosityBase() if method == "weiler" else None
    return (
        step.getValueUInt(step.SOLVER_ITERATIONS), step.getValueUInt(step.SOLVER_ITERATIONS_V),
        viscosity.getValueUInt(viscosity.ITERATIONS) if viscosity else 0,
    )


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
    edge, spacing, dt, iterations, warm, steps, threads, *method = sys.argv[1:]
    os.environ["OMP_NUM_THREADS"] = threads
    main(int(edge), float(spacing), float(dt), int(iterations), int(warm), int(steps), *method)
