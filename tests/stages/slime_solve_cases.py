"""Particle sets for the solves of viscous and incompressible liquids: a disordered blob with all that stands beside it."""

import numpy as np
from liquid_cases import DX, H

from melt import params as P
from melt.check.compare import run_stage
from melt.fields import FIELDS
from melt.stages import STAGES
from melt.state import dtype_of, shape_of

FREE, HELD, SOLID, WALL, MASSLESS = range(5)
TUPLES = dict(
    smoothing=(P.Smoothing, dict(support=H, kernel=P.CUBIC, laplacian=P.L_VISC, dimension=3)),
    period=(P.Period, dict.fromkeys(P.Period._fields, 0.0)),
    poisson=(P.Poisson, dict(rest_density=1000.0, floor=1e-4 * H**2, pull=0.02, full_share=0.85, clamp=0)),
    viscous=(
        P.Viscous,
        dict(
            law=0, mu=50.0, slope=0.0, reference_temperature=20.0, power=1.0, yield_stress=0.0, yield_rate=0.0, smallest=0.0,
            largest=1e9, wall=0.8, strength=10.0, floor=1e-4 * H**2, gamma=0.0,
        ),
    ),
)
SIZES = dict(reduction=64)


def arrays(precision="double", n=None, near=None, **given):
    """Return all fields of the solves: those given, the lists ``near`` (rows of neighbours), else zeros."""
    near = [[]] * n if near is None else near
    n, width = len(near), max([4] + [len(row) for row in near])
    index = np.full((n, width), -987654321)
    for i, row in enumerate(near):
        index[i, : len(row)] = row
    given |= dict(neighbour_count=[len(row) for row in near], neighbour_index=index)
    sizes, a = {**SIZES, "particle": n, "neighbour": width}, {}
    for stage in STAGES.values():
        if stage.file not in ("viscosity_law", "viscous", "viscous_cg", "poisson", "poisson_cg"):
            continue
        for name in stage.reads + stage.writes:
            field = FIELDS[name]
            value = given.get(name)
            value = np.zeros(shape_of(field, sizes)) if value is None else np.asarray(value)
            a[name] = np.ascontiguousarray(value, dtype=dtype_of(field, precision))
    return a


def run(stage, backend, a, dt=0.0, renamed=None, **changes):
    """Run a stage, put what it writes into ``a`` and return that; ``renamed``: names of other arrays for arguments."""
    real = a["mass"].dtype.type
    params = {}
    for name in STAGES[stage].params:
        if name == "dt":
            params[name] = real(dt)
            continue
        kind, values = TUPLES[name]
        params[name] = P.make(kind, real, **{**values, **{k: v for k, v in changes.items() if k in values}})
    used = {**a, **{k: a[v] for k, v in (renamed or {}).items()}}
    out = run_stage(stage, backend, used, params)
    a.update(out)
    return out


def blob(kind):
    """Return (x (n, 3), role, length) of about 200 particles in disorder: "3d", "2d", or "box", periodic along x."""
    rng = np.random.default_rng(7)
    shape = (14, 1, 15) if kind == "2d" else (6, 6, 6)
    cells = np.indices(shape).reshape(3, -1).T.astype(float)
    x = (cells + rng.uniform(-0.25, 0.25, cells.shape)) * DX
    n = len(x)
    role = np.full(n, FREE)
    role[cells[:, 2] == 0] = WALL
    inner = np.flatnonzero(cells[:, 2] > 1)
    role[rng.choice(inner, 12, replace=False)] = np.repeat([HELD, SOLID, MASSLESS], 4)
    if kind == "2d":
        x[:, 1] = 0.3
    length = shape[0] * DX if kind == "box" else 0.0
    order = rng.permutation(n)
    return x[order], role[order], length


def separations(x, length):
    """Return x_ij = x_i - x_j (n, n, 3) and r_ij, nearest image along x."""
    d = x[:, None] - x[None]
    if length:
        d[..., 0] -= length * np.rint(d[..., 0] / length)
    return d, np.sqrt((d**2).sum(axis=2))


def slope_over_r(r, flat):
    """F = -W'(r)/r of the cubic spline, 0 at r = 0."""
    q = r / H
    scale = 40 / (7 * np.pi * H**3) if flat else 8 / (np.pi * H**4)
    dW = scale * np.where(q < 0.5, 18 * q**2 - 12 * q, np.where(q < 1, -6 * (1 - q) ** 2, 0.0))
    return np.where(r > 0, -dW / np.where(r > 0, r, 1.0), 0.0)


def scene(kind, precision="double"):
    """Return (fields of the solves, changes of parameters, what the matrices are made of) of a `blob`."""
    x, role, length = blob(kind)
    n, rng = len(x), np.random.default_rng(11)
    d, r = separations(x, length)
    liquid = np.isin(role, (FREE, HELD))
    has_row = role != WALL
    near = [np.flatnonzero((r[i] < H) & (np.arange(n) != i)) if has_row[i] else [] for i in range(n)]
    V = DX ** (2 if kind == "2d" else 3) * rng.uniform(0.9, 1.1, n)
    V[role == MASSLESS] = 0.0
    mass = 1000 * V * rng.uniform(0.7, 1.3, n)
    flat = kind == "2d"
    F = np.where(r < H, slope_over_r(r, flat), 0.0)
    g = -(V[None, :] * F)[..., None] * d  # g_ij = V_j grad_i W_ij
    width = max(4, max(len(row) for row in near))
    pair_gradient = np.zeros((3, n, width))
    for i, row in enumerate(near):
        pair_gradient[:, i, : len(row)] = g[i, row].T
    mobility = np.where(np.isin(role, (FREE, SOLID)), 1 / np.where(mass > 0, mass, 1.0), 0.0)
    given = dict(
        position=x.T, volume=V, mass=mass, mobility=mobility, viscosity=np.where(liquid, rng.uniform(5e4, 2e6, n), 0.0),
        velocity=rng.normal(size=(3, n)), pair_gradient=pair_gradient, phase=np.zeros(n),
        completed_ratio=rng.uniform(0.4, 1.05, n), density_ratio=rng.uniform(0.4, 1.05, n),
        dfsph_factor=np.where(role == FREE, 1.0, 0.0),
        ghost_laplacian=np.where((role == FREE) & (rng.random(n) < 0.3), rng.uniform(0, 20, n), 0.0),
    )
    if flat:
        given["velocity"][1] = 0.0
    changes = dict(dimension=2 if flat else 3, strength=8.0 if flat else 10.0)
    if length:
        changes |= dict(length_x=length, inverse_x=1 / length)
    parts = dict(d=d, r=r, F=F, g=g, V=V, role=role, given=given, strength=changes["strength"])
    return arrays(precision, near=near, **given), changes, parts

