"""Small particle sets with brute-force neighbour lists, for the tests of the liquid's stages."""

import itertools

import numpy as np
import pytest

from melt import params as P
from melt.check.compare import run_stage
from melt.stages import STAGES

H, DX = 0.5, 0.2
BACKENDS = ("reference", "cpu", "cuda-emulated")
REALS = {
    "single": (np.float32, np.float32),
    "mixed": (np.float32, np.float64),
    "double": (np.float64, np.float64),
}

FLUID = dict(
    sound_speed=10,
    viscosity=P.ARTIFICIAL,
    alpha=0,
    mu=0,
    solid_friction=0,
    wall_friction=0,
    mirror=1,
    clamp=1,
    density_factor=1,
    minimum_volume=DX**3,
    number_density=1,
    gravity_x=0,
    gravity_y=0,
    gravity_z=0,
    expansion=0,
    reference_temperature=20,
    drag=0,
    xsph=0,
    surface_tension=0,
)
TUPLES = dict(
    smoothing=(P.Smoothing, dict(support=H, kernel=P.CUBIC, laplacian=P.L_VISC)),
    fluid=(P.Fluid, FLUID),
    lattice=(
        P.Lattice,
        dict(
            width=2,
            spacing=DX,
            solid_volume=P.VOLUME_REST,
            solid_scale=1,
            rotation=P.ROTATION_HORN,
            iterations=60,
            tolerance=1e-9,
            stiffness=1,
            damping=0,
            refill=P.REFILL_ALL,
            connect=26,
        ),
    ),
    contact=(P.Contact, dict(distance=DX, stiffness=0.25, damping=0, friction=0, connect=26)),
    guard=(P.Guard, dict(distance=DX / 2)),
    domain=(P.Domain, dict(lower_x=0, lower_y=0, lower_z=0, upper_x=1, upper_y=1, upper_z=1, delete=1)),
)

everywhere = pytest.mark.parametrize("backend", BACKENDS)
both = pytest.mark.parametrize("precision", ("single", "double"))


def tolerance(precision, stage=None):
    """Relative tolerance of a hand-computed value."""
    return 2e-5 if precision != "double" else 1e-11


def box(nx, ny, nz, origin=(0, 0, 0), dx=DX):
    """Lattice points (n, 3), x fastest, centres at (i + 1/2) dx beyond the origin."""
    z, y, x = np.meshgrid(np.arange(nz), np.arange(ny), np.arange(nx), indexing="ij")
    return (np.column_stack([x.ravel(), y.ravel(), z.ravel()]) + 0.5) * dx + np.asarray(origin, float)


def rows_of(x, phase, h=H):
    """Neighbours strictly within h, ascending, without itself; none for walls and inactive."""
    r2 = ((x[:, None] - x[None]) ** 2).sum(axis=2)
    near = (r2 < h * h * (1 - 1e-12)) & (phase != 5)[None] & (phase < 2)[:, None]
    np.fill_diagonal(near, False)
    count = near.sum(axis=1).astype(np.int32)
    index = np.full((len(x), max(8, count.max(initial=0))), -987654321, np.int32)
    for i, row in enumerate(near):
        index[i, : count[i]] = np.flatnonzero(row)
    return count, index


def particles(x, phase=0, precision="double", **fields):
    """Return arrays of the fields of these stages; defaults are a resting liquid of 1000 kg/m^3."""
    real, place = REALS[precision]
    x = np.asarray(x, float).reshape(-1, 3)
    n = len(x)
    phase = np.broadcast_to(np.asarray(phase, np.int32), n).copy()
    count, index = rows_of(x, phase)
    a = dict(
        position=np.ascontiguousarray(x.T, dtype=place),
        phase=phase,
        neighbour_count=count,
        neighbour_index=index,
        velocity=np.zeros((3, n)),
        mass=np.full(n, 8.0),
        rest_volume=np.full(n, DX**3),
        volume=np.full(n, DX**3),
        density=np.full(n, 1000.0),
        pressure=np.zeros(n),
        temperature=np.full(n, 20.0),
        force=np.zeros((3, n)),
        velocity_next=np.zeros((3, n)),
        position_next=np.zeros((3, n), place),
        offenders=np.zeros(n, np.int32),
        surface=np.zeros(n, np.int32),
        site=np.full(n, -1, np.int32),
        motion_bounds=np.zeros((2, 64)),
    )
    # boundaries carry the pressure around; a test that does not say otherwise has one pressure everywhere
    fields.setdefault("boundary_pressure", np.array(fields.get("pressure", np.zeros(n)), float))
    for name, value in fields.items():
        value = np.asarray(value)
        like = a.get(name)
        a[name] = value.astype(
            np.int32 if value.dtype.kind in "iu" and (like is None or like.dtype == np.int32) else float
        )
    for name, value in a.items():
        if value.dtype.kind == "f" and not name.startswith("position"):
            a[name] = np.ascontiguousarray(value, dtype=real)
    a["position_next"] = a["position_next"].astype(place)
    return a


def solid_sites(a, cells, component=0):
    """Add the site fields of solid particles: ``cells`` (s, 3) voxels of the solids in order."""
    cells = np.asarray(cells).reshape(-1, 3)
    solid = np.flatnonzero(a["phase"] == 1)
    component = np.broadcast_to(np.asarray(component), len(solid))
    look = {(c, *map(int, v)): s for s, (c, v) in enumerate(zip(component, cells))}
    offsets = list(itertools.product(range(-2, 3), repeat=3))
    region = np.full((len(solid), len(offsets)), -1, np.int32)
    for s, (c, v) in enumerate(zip(component, cells)):
        region[s] = [look.get((c, *(int(p + o) for p, o in zip(v, off))), -1) for off in offsets]
    direct = [k for k, off in enumerate(offsets) if max(map(abs, off)) <= 1]
    a["site"][solid] = np.arange(len(solid))
    a.update(
        site_particle=solid.astype(np.int32),
        site_cell=np.ascontiguousarray(cells.T, np.int32),
        site_component=component.astype(np.int32),
        site_region=region,
        site_region_count=(region >= 0).sum(axis=1).astype(np.int32),
        site_link_count=(region[:, direct] >= 0).sum(axis=1).astype(np.int32),
        site_rest=np.ascontiguousarray((cells.T + 0.5) * DX, dtype=a["mass"].dtype),
        rest_sum=np.zeros(len(solid), a["mass"].dtype),
        goal=np.zeros((3, len(solid)), a["mass"].dtype),
    )
    return a


def run(stage, backend, a, **changes):
    """Run a stage on ``a``; keywords change parameters (``alpha=0.2``) or give scalars (``dt=...``)."""
    real = a["mass"].dtype.type
    params = {}
    for name in STAGES[stage].params:
        if name in TUPLES:
            kind, values = TUPLES[name]
            params[name] = P.make(
                kind, real, **{**values, **{k: v for k, v in changes.items() if k in values}}
            )
        else:
            params[name] = real(changes[name])
    return run_stage(stage, backend, a, params)
