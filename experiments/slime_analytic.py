"""Slime: exact solutions of viscous and of free flow (plates, vortices, films, tanks, rotating and stretching bodies).

Two dimensions, double precision, the numbers of the scenes unless a row says otherwise. L2 of a velocity is that of its error
over that of the exact profile, over all particles; pressures are over rho g H, and those in the middle of the rotating square
are means over w t = 0.045 to 0.125, a window chosen after the noise of the first steps was seen. Nodes are read, also where APIC
particles carry the mass. "Operator" rows measure what the pair forces dissipate in a given flow over what the liquid would: they
tell the viscosity of an arrangement of particles, whatever the rest of the method does. With APIC particles energy is lost in every
transfer, so the more of it the shorter the step (ellipse). Rows without a bound claim nothing.
"""

import h5py
import numpy as np

from experiments import _slime_patch as patch
from experiments import _slime_plates as plates
from experiments import _slime_rest as rest
from experiments._slime_rows import all_rows

NO_GHOSTS = {"ghosts": False}
WIDE = ("solver.support=4.0", "domain.upper=[0.009, 0.0, 0.01]", "domain.walls={sides=['floor', 'lid'], layers=4}",
        "fluid.fill=[{lower=[0.0, -1e-3, 0.0], upper=[0.009, 1e-3, 0.01]}]")
DISORDER = f"fluid.jitter={plates.NOISY}"
#: Name -> (case, arguments, keywords).
CASES = {
    "couette/20": (plates.start_up, ("couette", 20), {}),
    "couette/40": (plates.start_up, ("couette", 40), {}),
    "couette/40, a quarter of dt": (plates.start_up, ("couette", 40, "time.dt=0.25 ms"), {}),
    "poiseuille/20": (plates.start_up, ("poiseuille", 20), {}),
    "poiseuille/40": (plates.start_up, ("poiseuille", 40), {}),
    "poiseuille/40, walls as they are": (plates.start_up, ("poiseuille", 40, "viscosity.wall=0.5"), {}),
    "poiseuille/20, walls as they are": (plates.start_up, ("poiseuille", 20, "viscosity.wall=0.5"), {}),
    "poiseuille/40, disordered": (plates.start_up, ("poiseuille", 40, DISORDER), {}),
    "poiseuille/40, h = 4 d0": (plates.start_up, ("poiseuille", 40, *WIDE), {}),
    "vortices/nodes": (plates.vortices, ("time.dt=2.5 ms",), {}),
    "vortices/nodes, disordered": (plates.vortices, ("time.dt=2.5 ms", DISORDER), {}),
    "vortices/nodes, disordered, h = 2.6 d0": (plates.vortices, ("time.dt=2.5 ms", DISORDER, "solver.support=2.6"), {}),
    "vortices/APIC": (plates.vortices, ("time.dt=2.5 ms", "solver.apic={}"), {}),
    "vortices/APIC, support 0.7": (plates.vortices, ("time.dt=2.5 ms", "solver.apic={support = 0.7}"), {}),
    "operator/start": (plates.operator, ("time.dt=2.5 ms",), {"end": 0.0}),
    "operator/after 0.2 s": (plates.operator, ("time.dt=2.5 ms",), {}),
    "operator/disordered, start": (plates.operator, ("time.dt=2.5 ms", DISORDER), {"end": 0.0}),
    "operator/disordered, after 0.2 s": (plates.operator, ("time.dt=2.5 ms", DISORDER), {}),
    "film/20, DFSPH": (plates.film, (20,), {}),
    "film/20, hybrid": (plates.film, (20, 0.1, "solver.pressure=hybrid", "solver.ghosts={}"), {}),
    "film/40, hybrid": (plates.film, (40, 0.1, "solver.pressure=hybrid", "solver.ghosts={}"), {}),
    "tank/nodes": (rest.tank, (), {"end": 1.0}),
    "tank/APIC": (rest.tank, ("solver.apic={}",), {"end": 1.0}),
    "tank/APIC, h = 2 d0": (rest.tank, ("solver.apic={}", "solver.support=2.0"), {"end": 1.0}),
    "tank/nodes, no pull": (rest.tank, ("solver.dfsph.pull=0",), {"end": 1.0}),
    "tank/DFSPH": (rest.tank, ("solver.pressure=dfsph",), {"end": 1.0, **NO_GHOSTS}),
    "tank/without ghosts": (rest.tank, (), {"end": 1.0, **NO_GHOSTS}),
    "square/APIC": (patch.square, (), {}),
    "square/nodes": (patch.square, (), {"nodes": True}),
    "square/DFSPH": (patch.square, ("solver.pressure=dfsph",), NO_GHOSTS),
    "ellipse/DFSPH": (patch.ellipse, ("solver.pressure=dfsph",), {"nodes": True, **NO_GHOSTS}),
    "ellipse/nodes": (patch.ellipse, (), {"nodes": True}),
    "ellipse/APIC": (patch.ellipse, (), {}),
    "ellipse/APIC, no pull": (patch.ellipse, ("solver.dfsph.pull=0",), {}),
    "ellipse/APIC, twice dt": (patch.ellipse, ("time.dt=20 ms",), {}),
    "ellipse/APIC, half of dt": (patch.ellipse, ("time.dt=5 ms",), {}),
    "drop/APIC": (patch.drop, (), {}),
}
QUICK = {"couette/20", "film/20, hybrid", "ellipse/APIC"}


def run(out, quick=False, say=print):
    """Run all cases; ``quick``: a few of them, nothing is judged."""
    with h5py.File(out, "w") as file:
        file.attrs["quick"] = quick
        for name, (case, arguments, options) in CASES.items():
            if quick and name not in QUICK:
                continue
            try:
                values = case(*arguments, **options)
            except Exception as error:  # it is published
                values = {"failed": f"{type(error).__name__}: {error}"[:300]}
            group = file.create_group(name.replace("/", ": "))
            for key, value in values.items():
                if isinstance(value, np.ndarray):
                    group[key] = value
                else:
                    group.attrs[key] = value
            say(f"{name}: " + ", ".join(f"{k} {_short(v)}" for k, v in values.items() if not isinstance(v, np.ndarray)))


def _short(value):
    return f"{value:.4g}" if isinstance(value, (float, np.floating)) else str(value)


def report(path):
    """Return the rows."""
    with h5py.File(path) as file:
        return all_rows(file)
