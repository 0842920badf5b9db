"""Particle sets for the stages of DFSPH and of the motion of slime; arrays of any registered field, lists by brute force."""

import numpy as np
from stage_runs import run_with

from melt import params as P
from melt.fields import FIELDS
from melt.stages import STAGES
from melt.state import dtype_of, shape_of

H, D = 0.5, 0.2
BACKENDS = ("reference", "cpu", "cuda-emulated")
REAL = {"single": np.float32, "mixed": np.float32, "double": np.float64}
CLOSED = dict(
    length_x=0, length_y=0, length_z=0, inverse_x=0, inverse_y=0, inverse_z=0, lower_x=0, lower_y=0, lower_z=0
)
TUPLES = dict(
    smoothing=(P.Smoothing, dict(support=H, kernel=P.CUBIC, laplacian=P.L_VISC, dimension=3)),
    period=(P.Period, CLOSED),
    dfsph=(P.Dfsph, dict(omega=0.5, warm=0.5, warm_limit=10.0, fewest=0, least=1e-6 / H**2)),
    fluid=(P.Fluid, {**dict.fromkeys(P.Fluid._fields, 0), "gravity_x": 1, "gravity_y": -2, "gravity_z": -9.81}),
)


def along(axis, length, lower=0.0):
    """Return the changes of a period tuple that make an axis periodic."""
    return {f"length_{axis}": length, f"inverse_{axis}": 1 / length, f"lower_{axis}": lower}


def rows_of(x, phase, h=H, period=(0, 0, 0)):
    """Return the lists: neighbours within h of the nearest image, none for walls and inactive slots."""
    d = x[:, None] - x[None]
    for a, length in enumerate(period):
        if length:
            d[..., a] -= length * np.rint(d[..., a] / length)
    near = ((d**2).sum(axis=2) < h * h * (1 - 1e-12)) & (phase != 5)[None] & ((phase != 2) & (phase != 5))[:, None]
    np.fill_diagonal(near, False)
    count = near.sum(axis=1)
    index = np.full((len(x), max(8, count.max(initial=0))), -987654321)
    for i, row in enumerate(near):
        index[i, : count[i]] = np.flatnonzero(row)
    return count, index


def arrays(x, phase=0, precision="double", period=(0, 0, 0), stages=(), **fields):
    """Return the fields of ``stages`` for particles at x (n, 3): liquid of 1000 kg/m^3 at rest unless told."""
    x = np.asarray(x, float).reshape(-1, 3)
    n = len(x)
    phase = np.broadcast_to(np.asarray(phase), n)
    count, index = rows_of(x, phase, period=period)
    given = dict(
        position=x.T, position_kept=x.T, phase=phase, neighbour_count=count, neighbour_index=index,
        volume=np.full(n, D**3), mass=np.full(n, 1000 * D**3),
    )
    given.update(fields)
    volume, mass = (np.broadcast_to(np.asarray(given[k], float), n) for k in ("volume", "mass"))
    given.update(volume=volume, mass=mass)
    free = ((phase == 0) | (phase == 1)) & (mass > 0)
    given.setdefault("mobility", np.where(free, 1 / np.where(free, mass, 1), 0.0))
    sizes = dict(
        particle=n, neighbour=given["neighbour_index"].shape[1], reduction=64,
        apic=np.shape(fields.get("apic_phase", []))[-1], driver=np.shape(fields.get("driver_motion", [[]]))[-1],
        nozzle=np.shape(fields.get("nozzle_speed", []))[-1],
    )
    a = {}
    for name in dict.fromkeys(f for s in stages for f in STAGES[s].reads + STAGES[s].writes):
        kind = dtype_of(FIELDS[name], precision)
        value = given.get(name)
        a[name] = np.zeros(shape_of(FIELDS[name], sizes), kind) if value is None else np.array(value, dtype=kind, order="C")
    return a


def run(stage, backend, a, precision="double", **changes):
    """Run a stage on ``a``, put what it wrote there and return it; keywords change parameters or give scalars."""
    return run_with(stage, backend, a, REAL[precision], changes, TUPLES)


def box(n, d=D):
    """Return lattice points (n^3, 3)."""
    return (np.indices((n, n, n)).reshape(3, -1).T + 0.5) * d
