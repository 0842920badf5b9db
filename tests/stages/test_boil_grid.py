"""Temperature on a grid: eq (9) (boiling 2.3, V11)."""

import numpy as np
import pytest
from boil_cases import ALPHA, C_P, TANK, run
from liquid_cases import both, everywhere
from pbf_cases import D, arrays

NX, NY, NZ = SHAPE = TANK["nx"], TANK["ny"], TANK["nz"]
CELLS = NX * NY * NZ
REALS = {"single": np.float32, "double": np.float64}


def grid(T, precision="double"):
    """Fields of a grid with the temperatures T (nz, ny, nx)."""
    T = np.ascontiguousarray(np.asarray(T, float).ravel(), REALS[precision])
    return dict(voxel_temperature=T, voxel_temperature_next=np.zeros_like(T), heater_heat=np.zeros(64))


@everywhere
@both
def test_modes_decay_by_the_discrete_factor(backend, precision):
    """V11: a cosine of m half waves shrinks by 1 - 2 a (1 - cos k d) in each step, exactly, along every axis."""
    a, dt = 0.1, 0.1 * D**2 / ALPHA
    for axis, cells in enumerate((NZ, NY, NX)):
        for m in range(1, cells):
            k = np.pi * m / cells
            shape = [1, 1, 1]
            shape[axis] = cells
            mode = np.broadcast_to(np.cos(k * (np.arange(cells) + 0.5)).reshape(shape), (NZ, NY, NX))
            out = run("voxel_heat", backend, grid(60 + 30 * mode, precision), dt=dt)["voxel_temperature_next"]
            right = 60 + 30 * mode.ravel() * (1 - 2 * a * (1 - np.cos(k)))
            assert np.abs(out - right).max() <= (1e-12 if precision == "double" else 1e-6) * 90


@everywhere
def test_a_hot_cell_warms_its_neighbours_and_no_others(backend):
    a, dt = 0.1, 0.1 * D**2 / ALPHA
    for where, faces in (((0, 0, 0), 3), ((2, 1, 1), 6), ((4, 0, 2), 4)):
        T = np.full((NZ, NY, NX), 20.0)
        T[where] = 120
        out = run("voxel_heat", backend, grid(T), dt=dt)["voxel_temperature_next"].reshape(T.shape)
        right = T + 0
        right[where] -= 100 * a * faces
        near = np.abs(np.indices(T.shape) - np.array(where)[:, None, None, None]).sum(axis=0) == 1
        right[near] += 100 * a
        assert near.sum() == faces and out == pytest.approx(right, rel=1e-14)


@everywhere
def test_thin_grids(backend):
    """One cell keeps its temperature; a column of two exchanges."""
    for shape, T, right in (((1, 1, 1), [50.0], [50]), ((1, 1, 2), [20.0, 100], [28, 92]), ((2, 1, 1), [20.0, 100], [28, 92])):
        nx, ny, nz = shape
        out = run("voxel_heat", backend, grid(T), dt=0.1 * D**2 / ALPHA, nx=nx, ny=ny, nz=nz)
        assert out["voxel_temperature_next"] == pytest.approx(right, rel=1e-14)


def test_grid_keeps_heat_and_range_over_a_thousand_steps():
    """V11, at the step limit alpha dt/d^2 = 1/6."""
    rng = np.random.default_rng(2)
    g = grid(rng.uniform(20, 100, CELLS))
    start, low, high = g["voxel_temperature"].sum(), g["voxel_temperature"].min(), g["voxel_temperature"].max()
    for _ in range(1000):
        g["voxel_temperature"] = run("voxel_heat", "cpu", g, dt=D**2 / ALPHA / 6)["voxel_temperature_next"]
        assert g["voxel_temperature"].min() >= low - 1e-12 and g["voxel_temperature"].max() <= high + 1e-12
    assert g["voxel_temperature"].sum() == pytest.approx(start, rel=1e-12)
    assert np.ptp(g["voxel_temperature"]) < 1e-9


@everywhere
@both
def test_heater_warms_the_lowest_cells_over_it(backend, precision):
    """Centres at (i + 1/2) d: the rectangle 0..2 d, -d..d holds those of columns 0, 1 and row 0."""
    g = grid(np.full((NZ, NY, NX), 20.0), precision)
    out = run("voxel_heater", backend, g, target=120.0, share=0.3)
    right = np.full((NZ, NY, NX), 20.0)
    right[0, 0, :2] = 50
    assert out["voxel_temperature"] == pytest.approx(right.ravel(), rel=1e-6)
    assert out["heater_heat"].sum() == pytest.approx(2 * 30 * 1000 * C_P * D**3, rel=1e-6)
    assert out["heater_heat"].dtype == np.float64
    out = run("voxel_heater", backend, g, target=115.3, share=1.0, heater_upper_x=9.0, heater_lower_y=0.5 * D, heater_upper_y=9.0)
    assert (out["voxel_temperature"][: NX * NY] == g["voxel_temperature"].dtype.type(115.3)).all()
    assert (out["voxel_temperature"][NX * NY :] == 20).all()


@everywhere
@both
def test_liquid_takes_the_temperature_of_the_grid(backend, precision):
    """A linear field is exact between the outermost centres and constant beyond them; T_b is the most; liquid only."""
    z, y, x = (np.indices((NZ, NY, NX)) + 0.5) * D
    field = lambda p: 30 + 400 * p[..., 0] - 200 * p[..., 1] + 300 * p[..., 2]  # noqa: E731
    T = field(np.stack([x, y, z], axis=-1))
    rng = np.random.default_rng(1)
    at = np.concatenate([rng.uniform(-1, 6, (60, 3)) * D, [[0, 0, 0], [NX * D, NY * D, NZ * D], [1e9, -1e9, D]], np.full((1, 3), D)])
    phase = np.zeros(64, int)
    phase[-1] = 3
    a = arrays(at, phase, precision, temperature=np.full(64, 55.0))
    a.update(grid(T, precision))
    out = run("voxel_sample", backend, a)["temperature"]
    right = field(np.clip(at, 0.5 * D, (np.array(SHAPE) - 0.5) * D))
    assert out[:-1] == pytest.approx(right[:-1], rel=1e-12 if precision == "double" else 1e-5) and out[-1] == 55
    out = run("voxel_sample", backend, a, boiling_point=50.0)["temperature"]
    assert out[:-1] == pytest.approx(np.minimum(right[:-1], 50), rel=1e-12 if precision == "double" else 1e-5)
    assert out[-1] == 55 and (right > 50).any()


@everywhere
def test_sample_of_a_grid_one_cell_thick(backend):
    a = arrays([[-D, 0, 0], [D, D, D], [9, 9, 9], [np.nan, 0, 0]])
    a.update(grid([10.0, 30.0]))
    out = run("voxel_sample", backend, a, nx=1, ny=1, nz=2)["temperature"]
    assert out == pytest.approx([10, 20, 30, 10], rel=1e-14)
