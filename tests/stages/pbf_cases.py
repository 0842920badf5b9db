"""Particle sets for the stages of the position based fluid: lattices, clouds, and parameter tuples of any support."""

import numpy as np
from liquid_cases import FLUID, REALS

from melt import params as P
from melt.check.compare import run_stage
from melt.fields import FIELDS
from melt.position_based import POINTS, SHORTEST, kernel_table, lattice_sums, squared_gradients
from melt.stages import STAGES
from melt.state import dtype_of, shape_of

D = 0.02  # spacing [m]
MASS = 1000 * D**3


def d0(ratio, mass=MASS):
    """D0 of a particle inside the lattice [1/(kg m^2)]."""
    return squared_gradients(ratio) / (lattice_sums(ratio).gradient ** 2 * D**2 * mass)


def pbf_tuple(ratio=2.2, real=np.float64, **changes):
    """Return a `Pbf` tuple: uniform, omega = eps_rel = 1, no artificial pressure unless told."""
    R, sums = ratio * D, lattice_sums(ratio)
    values = dict(
        spacing=D, support=R, uniform=1,
        value_scale=315 / (64 * np.pi * R**3 * sums.value), gradient_scale=45 / (np.pi * R**4 * sums.gradient),
        table_start=SHORTEST, table_step=(POINTS - 1) / (ratio - SHORTEST), table_last=POINTS - 1,
        omega=1.0, softening=d0(ratio), minimum_error=-1.0, push=0.0, push_scale=1 / 0.96, blend=12.0, vorticity=0.0,
        iterations=4, minimum_iterations=2, minimum_support=1.8 * D, height_share=0.5, minimum_precision=0.0,
        precision_time=0.05, floor=0.0, inverse_bin=4 / D,
    )
    values["same_iterations"] = changes.get("uniform", 1)
    return P.make(P.Pbf, real, **{**values, **changes})


def vessel_tuple(real=np.float64, **sides):
    far = dict(lower_x=-1e30, lower_y=-1e30, lower_z=-1e30, upper_x=1e30, upper_y=1e30, upper_z=1e30)
    return P.make(P.Vessel, real, **{**far, **sides})


def lattice(nx, ny=None, nz=None):
    """Lattice points (n, 3) at (i + 1/2) d."""
    cells = np.indices((nx, ny or nx, nz or nx)).reshape(3, -1).T
    return (cells + 0.5) * D


def arrays(x, phase=0, precision="double", ratio=2.2, **fields):
    """Return all fields of these stages for particles at x (n, 3), with brute-force lists within ``ratio`` spacings."""
    real, _ = REALS[precision]
    x = np.asarray(x, float).reshape(-1, 3)
    n = len(x)
    phase = np.broadcast_to(np.asarray(phase, np.int32), n).copy()
    r2 = ((x[:, None] - x[None]) ** 2).sum(axis=2)
    near = (r2 < (ratio * D) ** 2 * (1 - 1e-12)) & (phase != 5)[None] & (phase < 2)[:, None]
    np.fill_diagonal(near, False)
    count = near.sum(axis=1)
    index = np.full((n, max(8, count.max(initial=0))), -987654321)
    for i, row in enumerate(near):
        index[i, : count[i]] = np.flatnonzero(row)
    liquid = np.flatnonzero(phase == 0)
    given = dict(
        position=x.T, position_predicted=x.T, phase=phase, id=np.arange(n), mass=np.full(n, MASS), rest_volume=np.full(n, D**3),
        volume=np.where(phase < 5, D**3, 0.0), mobility=np.where(phase == 0, 1 / MASS, 0.0),
        neighbour_count=count, neighbour_index=index, kernel_scale=kernel_table(ratio),
        support_radius=np.where(phase == 0, ratio * D, 0.0), iterations=np.where(phase == 0, 4, 0),
        active_index=np.pad(liquid, (0, n - len(liquid)), constant_values=-1), active_count=[len(liquid)],
        effect_precision=np.where(phase == 0, 1.0, 0.0),
    )
    given.update(fields)
    sizes = dict(
        particle=n, neighbour=index.shape[1], table=POINTS, bin=40, chunk=1 + n // 256, reduction=64, cell=3, column=1, voxel=1, site=n,
    )
    a = {}
    for stage in STAGES.values():
        if not stage.equation.startswith("boiling"):
            continue
        for name in stage.reads + stage.writes:
            if name not in FIELDS:  # of general stages: the page names the field
                continue
            value = given.get(name)
            value = np.zeros(shape_of(FIELDS[name], sizes)) if value is None else value
            a[name] = np.ascontiguousarray(value, dtype=dtype_of(FIELDS[name], precision))
    return a


def run(stage, backend, a, pbf=None, **scalars):
    """Run a stage, put what it writes into ``a`` and return that."""
    real = a["mass"].dtype.type
    given = {"pbf": pbf or pbf_tuple(real=real), "vessel": scalars.pop("vessel", None) or vessel_tuple(real)}
    gravity = scalars.pop("gravity", 0.0)
    given["fluid"] = P.make(P.Fluid, real, **{**FLUID, "gravity_z": gravity})
    for name, value in scalars.items():
        given[name] = np.int32(value) if isinstance(value, int) else real(value)
    out = run_stage(stage, backend, a, {p: given[p] for p in STAGES[stage].params})
    a.update(out)
    return out
