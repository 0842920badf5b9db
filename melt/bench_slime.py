"""``melt bench --dfsph``: a dam break solved by DFSPH, in the state in which it splashes.

A cube of water collapses in a tank 2 edges long, 1 wide and 1.5 high until t = 0.64 s (edge 39 particles of 5 cm); then steps of
4 ms (shorter for larger cubes, which fall faster) are timed. Iterations are those that the tolerances ask for; milliseconds
per iteration are those of the stages that every iteration runs. `price` times the same collapse with one part added at a time.
"""

import math
import statistics
import time

import numpy as np

from melt.scene import scene_from_dict
from melt.simulation import Simulation

SIZES = (10_648, 59_319, 195_112)
SPACING, DT, SPLASH = 0.05, 0.004, 0.64
PRESSURE = ("pressure_acceleration", "pressure_update")
VISCOUS = ("viscous_apply", "viscous_step", "viscous_turn", "dilation")
POISSON = ("poisson_pairs", "poisson_start", "poisson_apply", "poisson_step", "poisson_turn", "poisson_finish", "poisson_acceleration")
GHOSTS = ("ghost_candidates", "ghost_thin", "ghost_list", "ghost_place", "ghost_volume", "ghost_complete")
APIC = ("apic_weights", "apic_to_nodes", "massless_velocity", "nodes_to_apic", "apic_move", "apic_sums")
#: What a step may have beyond DFSPH: (name, overrides of the scene's sections, the stages that it adds).
PARTS = [
    ("DFSPH alone", {}, ()),
    ("viscosity, split", {"viscosity": {"stokes": "split"}}, (*VISCOUS, "viscosity", "pair_shear", "viscous_start")),
    ("viscosity, augmented", {"viscosity": {"stokes": "al"}}, (*VISCOUS, "viscosity", "pair_shear", "viscous_start", "viscous_keep")),
    ("air ghosts", {"solver": {"ghosts": {}}}, GHOSTS),
    ("ghosts, Poisson equation", {"solver": {"pressure": "hybrid", "ghosts": {}}}, (*POISSON, *GHOSTS)),
    ("APIC, 8 per node", {"solver": {"apic": {}}}, APIC),
    ("semi-Lagrangian", {"solver": {"semi_lagrangian": True}}, ()),
]
_NAMES = "liquid wall nbrs mu ms/step best its:p+div its:visc ms/it:p ms/it:v lists error"
_COLUMNS = zip(_NAMES.split(), (9, 9, 6, 6, 9, 8, 11, 9, 9, 9, 8, 9))
HEADER = "".join(f"{name.replace(':', ' '):>{width}}" for name, width in _COLUMNS)


def step_of(edge):
    """Return the step of a cube ``edge`` particles high [s]: larger ones fall faster, at one Courant number."""
    return DT * min(1.0, math.sqrt(39 / edge))


def dam(particles, mu=0.0, precision="single", support=2.0, stokes="split", **parts):
    """Return a scene: a cube of about ``particles`` of liquid collapsing in a tank; ``parts``: further entries of [solver]."""
    edge = max(6, round(particles ** (1 / 3)))
    size = edge * SPACING
    dt = step_of(edge)
    scene = {
        "scene": {"name": f"dfsph_dam_{edge**3}"},
        "time": {"end": 10.0, "dt": dt, "n_sub": 1},
        "domain": {"upper": [2 * size, size, 1.5 * size], "spacing": SPACING, "walls": {"layers": 3}},
        "fluid": {"fill": [{"lower": [0, 0, 0], "upper": [size, size, size]}]},
        "solver": {"precision": precision, "pressure": "dfsph", "support": support, "dfsph": {"on_fail": "warn"}},
    }
    scene["solver"]["dfsph"]["semi_lagrangian"] = parts.pop("semi_lagrangian", False)
    scene["solver"].update(parts)
    if mu:
        scene["viscosity"] = {"mu": mu, "stokes": stokes, "tolerance": 1e-3}
    return scene_from_dict(scene)


def measure(scene, backend="cpu", until=None, steps=20):
    """Return the figures of a scene from the time ``until`` [s] (that of the splash, scaled with the cube's edge) on, as a dict."""
    sim = Simulation(scene, backend, timed=True)
    edge = np.ptp(sim.initial["position"][2, sim.initial["phase"] == 0]) + SPACING
    until = SPLASH * np.sqrt(edge / (39 * SPACING)) if until is None else until
    while sim.time < until:
        sim.step()
    walls, seconds, counts, errors = [], [], [], []
    for _ in range(steps):
        sim.do.seconds.clear()
        sim.do.notes.clear()
        began = time.perf_counter()
        sim.step()
        walls.append(1e3 * (time.perf_counter() - began))
        seconds.append(dict(sim.do.seconds))
        counts.append(dict(sim.do.notes))
        errors.append(sim.do.notes.get("density_residual", 0.0))
    count, phase = sim.state.read("neighbour_count"), sim.state.read("phase")
    liquid = phase == 0

    def per(names, iterations):
        runs = sum(c.get(i, 0) for c in counts for i in iterations)
        return 1e3 * sum(s.get(n, 0.0) for s in seconds for n in names) / max(runs, 1)

    def median(*names):
        return statistics.median(sum(c.get(n, 0) for n in names) for c in counts)

    def stage(name):
        return 1e3 * min(s.get(name, 0.0) for s in seconds)

    jacobi = ("density_iterations", "divergence_iterations")
    return {
        "liquid": int(liquid.sum()),
        "wall": int((phase == 2).sum()),
        "neighbours": float(count[liquid].mean()),
        "mu": float(scene.viscosity.mu if scene.viscosity else 0.0),
        "precision": sim.prepared.precision,
        "step_ms": statistics.median(walls),
        "step_ms_best": min(walls),
        "pressure_iterations": median("density_iterations"),
        "divergence_iterations": median("divergence_iterations"),
        "viscous_iterations": median("viscous_iterations"),
        "pressure_ms": per(PRESSURE, jacobi),
        "viscous_ms": per(VISCOUS, ("viscous_iterations",)),
        "poisson_iterations": median("poisson_iterations"),
        "lists_ms": stage("neighbours_grid") + stage("pair_gradient"),
        "density_error": float(np.mean(errors)),
        "time": sim.time,
        "ms": {n: stage(n) for n in seconds[0]},
    }


def line(f):
    """Return the figures as a line of the table."""
    its = f"{f['pressure_iterations']:.0f}+{f['divergence_iterations']:.0f}"
    return (
        f"{f['liquid']:>9,}{f['wall']:>9,}{f['neighbours']:>6.0f}{f['mu']:>6.3g}{f['step_ms']:>9.1f}{f['step_ms_best']:>8.1f}{its:>11}"
        f"{f['viscous_iterations']:>9.0f}{f['pressure_ms']:>9.2f}{f['viscous_ms']:>9.2f}{f['lists_ms']:>8.1f}{f['density_error']:>9.1e}"
    )


def price(particles, backend="cpu", steps=20, mu=50.0, say=print):
    """Return {part: figures} of the dam break with one part more than DFSPH: what its stages cost, and the whole step."""
    found = {}
    say(f"{'part':<28}{'ms of its stages':>17}{'ms/step':>9}{'best':>8}  iterations: pressure + divergence, viscosity, Poisson")
    for name, sections, stages in PARTS:
        viscous = sections.get("viscosity")
        scene = dam(particles, mu if viscous else 0.0, **(viscous or {}), **sections.get("solver", {}))
        f = found[name] = measure(scene, backend, steps=steps)
        f["part_ms"] = sum(f["ms"].get(s, 0.0) for s in stages)
        say(
            f"{name:<28}{f['part_ms']:>17.1f}{f['step_ms']:>9.1f}{f['step_ms_best']:>8.1f}  {f['pressure_iterations']:.0f} + "
            f"{f['divergence_iterations']:.0f}, {f['viscous_iterations']:.0f}, {f['poisson_iterations']:.0f}"
        )
    return found


def run(sizes=SIZES, backend="cpu", precision="single", support=2.0, viscosities=(0.0, 50.0), steps=20, out=None, say=print):
    """Measure each size without and with implicit viscosity, print a table, store it in HDF5 if ``out`` is given."""
    import h5py

    say(f"DFSPH, dam break while it splashes, dt {1e3 * DT:g} ms, support {support:g} spacings, {precision} precision")
    say(HEADER)
    results = []
    for n in sizes:
        for mu in viscosities:
            results.append(measure(dam(n, mu, precision, support), backend, steps=steps))
            say(line(results[-1]))
            slowest = sorted(results[-1]["ms"].items(), key=lambda q: -q[1])[:8]
            say("  " + ", ".join(f"{name} {ms:.1f}" for name, ms in slowest))
    if out:
        with h5py.File(out, "w") as file:
            for k, found in enumerate(results):
                group = file.create_group(f"run_{k:03d}")
                group.attrs.update({name: value for name, value in found.items() if name != "ms"})
                group.create_group("ms").attrs.update(found["ms"])
    return results
