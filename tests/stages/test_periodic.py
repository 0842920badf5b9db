"""Scalars of periodic axes, and neighbour lists in a periodic box."""

import numpy as np
import pytest
from dfsph_cases import BACKENDS, CLOSED, REAL, along

from melt import params as P
from melt.check.compare import run_stage
from melt.physics.period import into_box, near_cell, wrap

H = 0.46875  # 15/32: with positions in 1/4096 m every comparison is exact in float32


@pytest.mark.parametrize("real", (np.float32, np.float64))
def test_wrap(real):
    def of(d, length=2.0):
        return float(wrap(real(d), real(length), real(1 / length if length else 0)))

    assert [of(d) for d in (0.25, 0.75, 1.25, -1.25, 3.75, -4.25)] == [0.25, 0.75, -0.75, 0.75, -0.25, -0.25]
    assert of(1.0) == -of(-1.0) and of(3.0) == -of(-3.0)  # half way: still antisymmetric
    assert [of(d, 0) for d in (0.3, -1e9, 2.0**30)] == [float(real(0.3)), -1e9, 2.0**30]
    assert np.isnan(of(np.nan)) and not np.isfinite(of(np.inf))


def test_near_cells_are_distinct_ascending_and_complete():
    for count in range(1, 7):
        for cell in range(count):
            for length in (0.0, 1.0):
                found = [near_cell(cell, k, count, length) for k in range(3)]
                around = {cell - 1, cell, cell + 1}
                wanted = {c % count for c in around} if length else {c for c in around if 0 <= c < count}
                assert [c for c in found if c >= 0] == sorted(wanted), (count, cell, length)


@pytest.mark.parametrize("real", (np.float32, np.float64))
def test_into_box(real):
    def of(x):
        return float(into_box(real(x), real(-0.5), real(1.5), real(1 / 1.5)))

    assert [of(x) for x in (-0.5, 0.25, 1.0, 1.25, -0.75, 4.0)] == [-0.5, 0.25, -0.5, -0.25, 0.75, -0.5]
    assert float(into_box(real(7), real(1), real(0), real(0))) == 7


def lists(backend, x, phase, counts, origin, edge, precision, capacity=300, **period):
    """Sort particles by cell and return the lists as {particle: neighbours}, in the numbers of before."""
    real = REAL[precision]
    kind = np.float32 if precision == "single" else np.float64
    cell = np.clip(np.floor((x - origin) / edge), 0, np.array(counts) - 1).astype(int)
    linear = np.where(phase == 5, np.prod(counts), cell[:, 0] + counts[0] * (cell[:, 1] + counts[1] * cell[:, 2]))
    order = np.argsort(linear, kind="stable")
    a = dict(
        position=np.ascontiguousarray(x[order].T, kind), phase=phase[order].astype(np.int32),
        cell_start=np.searchsorted(linear[order], np.arange(np.prod(counts) + 2)).astype(np.int32),
        neighbour_count=np.zeros(len(x), np.int32), neighbour_index=np.zeros((len(x), capacity), np.int32),
    )
    params = dict(
        grid=P.make(
            P.Grid, real, origin_x=origin[0], origin_y=origin[1], origin_z=origin[2], inverse_cell=1 / edge,
            nx=counts[0], ny=counts[1], nz=counts[2],
        ),
        smoothing=P.make(P.Smoothing, real, support=H, kernel=0, laplacian=0),
        period=P.make(P.Period, real, **{**CLOSED, **period}),
    )
    out = run_stage("neighbours_periodic", backend, a, params)
    rows = [out["neighbour_index"][i, :c] for i, c in enumerate(np.minimum(out["neighbour_count"], capacity))]
    assert all((np.diff(row) > 0).all() for row in rows)
    return {int(order[i]): set(order[row].tolist()) for i, row in enumerate(rows)}, out["neighbour_count"]


def images(x, phase, length):
    """Return the same lists by explicit copies of the particles in 3^3 boxes."""
    rows = {i: set() for i in range(len(x))}
    for shift in np.stack(np.meshgrid(*[(-1, 0, 1)] * 3), -1).reshape(-1, 3):
        if (shift[np.array(length) == 0] != 0).any():
            continue
        r2 = ((x[:, None] - (x[None] + shift * length)) ** 2).sum(axis=2)
        for i, j in zip(*np.nonzero(r2 < H * H)):
            if i != j and phase[i] not in (2, 5) and phase[j] != 5:
                rows[int(i)].add(int(j))
    return rows


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("precision", ("single", "mixed", "double"))
@pytest.mark.parametrize("length", [(2.0, 0.0, 1.5), (1.0, 1.0, 1.0), (1.25, 3.0, 0.9375)])
def test_lists_are_those_of_explicit_images(backend, precision, length):
    """3 to 6 cells, 2 cells, and boxes of no whole number of cells; one axis open."""
    rng = np.random.default_rng(3)
    origin = np.array([0.25, -1.0, 0.0])
    size = np.where(np.array(length) > 0, length, 1.5)
    x = np.floor((origin + rng.random((250, 3)) * size) * 4096) / 4096
    phase = rng.choice([0, 1, 2, 5, 7], 250, p=[0.5, 0.1, 0.2, 0.1, 0.1])
    counts = [max(1, int(s / 0.46875)) for s in size]
    period = {}
    for axis, of, at in zip("xyz", length, origin):
        period.update(along(axis, of, at) if of else {})
    found, count = lists(backend, x, phase, counts, origin, 0.46875, precision, **period)
    assert found == images(x, phase, length)
    assert count.max() > 5


@pytest.mark.parametrize("backend", BACKENDS)
def test_count_is_true_beyond_the_capacity(backend):
    x = np.zeros((30, 3)) + np.arange(30)[:, None] / 4096
    _, count = lists(backend, x, np.zeros(30, int), (2, 1, 1), np.zeros(3), 0.5, "double", capacity=7, **along("x", 1.0))
    assert (count == 29).all()
