"""Small thermal inputs for stage tests: particles given one by one, lists by brute force."""

import numpy as np
import pytest

from melt import params as P
from melt._compile import Kernel
from melt.check.compare import run_stage

BACKENDS = ("reference", "cpu", "cuda")
H = 0.5


@pytest.fixture(autouse=True)
def emulate_cuda():
    """Run CUDA kernels on the host."""
    before, Kernel.emulated = Kernel.emulated, True
    yield
    Kernel.emulated = before


def particles(x, T, real=np.float64, *, phase=0, K=0.3, V=0.008, C=None, L=0.0, point=np.inf, e=0.0, molten=None):
    """Return the arrays of all heat stages for positions ``x`` (n, 3); others are numbers or lists."""
    x = np.atleast_2d(np.asarray(x, float)).reshape(-1, 3)
    n = len(x)
    full = lambda v: np.broadcast_to(np.asarray(v, float), n).astype(real)  # noqa: E731
    phase = np.broadcast_to(phase, n).astype(np.int32)
    C = full(V if C is None else C)
    r = np.sqrt(((x[:, None] - x[None]) ** 2).sum(axis=-1))
    near = (r < H) & (phase != 5)[None] & ((phase != 5) & (phase != 2))[:, None] & ~np.eye(n, dtype=bool)
    count = near.sum(axis=1).astype(np.int32)
    index = np.zeros((n, max(1, count.max(initial=0))), np.int32)
    for i in range(n):
        index[i, : count[i]] = np.flatnonzero(near[i])
    return {
        "position": np.ascontiguousarray(x.T).astype(real), "phase": phase, "temperature": full(T),
        "temperature_next": full(0), "conductivity": full(K), "heat_volume": full(V), "heat_capacity": C,
        "heat_capacity_molten": C.copy() if molten is None else full(molten), "latent_capacity": full(L),
        "latent_point": full(point), "latent_energy": full(e), "neighbour_count": count, "neighbour_index": index,
        "heat_rate": np.zeros(64, real), "cell_start": np.array([0, n, n], np.int32),
    }


def cells(a, edge=H):
    """Sort particles into cells of the grid at the origin; return (arrays, grid values)."""
    ijk = np.floor(a["position"].astype(float) / edge).astype(int)
    nx, ny, nz = (int(k) for k in np.maximum(1, ijk.max(axis=1) + 1))
    linear = (ijk[2] * ny + ijk[1]) * nx + ijk[0]
    order = np.argsort(linear, kind="stable")
    assert (order == np.arange(len(order))).all(), "give particles in cell order"
    start = np.searchsorted(linear, np.arange(nx * ny * nz + 1))
    start = np.append(start, len(order)).astype(np.int32)
    return {**a, "cell_start": start}, dict(nx=nx, ny=ny, nz=nz)


def constants(real=np.float64, *, dt=0.005, grid=None, **heat):
    """Return the parameters of all heat stages."""
    values = dict(
        law=P.HEAT_PAPER, current_volume=0, full_sweep=0, latent=0, ambient_temperature=20.0, ambient_transfer=0.1,
        full_neighbours=80.0, ambient_area=2.5, spacing=0.2, wall_fixed=0,
    )
    return {
        "smoothing": P.make(P.Smoothing, real, support=H, kernel=P.CUBIC, laplacian=heat.pop("laplacian", P.L_VISC)),
        "heat": P.make(P.Heat, real, **{**values, **heat}), "dt": real(dt), "reverse": real(0),
        "grid": P.make(P.Grid, real, origin_x=0, origin_y=0, origin_z=0, inverse_cell=1 / H,
                       **(grid or dict(nx=1, ny=1, nz=1))),
    }


def conducting(a, p):
    """Return the arrays with the conductances that the list solvers read."""
    a = {**a, "heat_conductance": np.zeros(a["neighbour_index"].shape, a["temperature"].dtype)}
    return {**a, **run_stage("heat_conductance", "reference", a, p)}


def solve(name, backend, a, p):
    """Run a heat solver's stage; return what it wrote."""
    return run_stage(name, backend, conducting(a, p), p)


def pairs(name, backend, a, p):
    """Run a pair stage; return (T, latent energy)."""
    out = solve(name, backend, a, p)
    return out.get("temperature", out.get("temperature_next")), out["latent_energy"]
