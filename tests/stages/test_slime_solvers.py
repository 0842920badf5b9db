"""Both linear systems against matrices that SciPy assembles and solves, in disorder beside walls, solids and held liquid."""

import numpy as np
import pytest
from liquid_cases import BACKENDS
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, cg, spsolve
from slime_solve_cases import FREE, TUPLES, H, run, scene

KINDS = ("3d", "2d", "box")
DT = 1e-3
kinds = pytest.mark.parametrize("kind", KINDS)


def matrix_poisson(parts):
    """Return S (n, n) and its rows with a pressure."""
    given, act = parts["given"], parts["role"] == FREE
    V, r2 = parts["V"] / np.maximum(given["completed_ratio"], 0.5), parts["r"] ** 2
    s = 2 * np.outer(V, V) * parts["F"] * r2 / (r2 + 1e-4 * H**2) * np.outer(act, act)
    S = np.diag(s.sum(axis=1) + np.where(act, 4 * V * given["ghost_laplacian"], 0.0)) - s
    return sparse.csr_matrix(S), act


def right_poisson(parts, wet):
    """Return b (n,); what has no pressure mirrors the velocity and counts twice."""
    given, v = parts["given"], parts["given"]["velocity"].T
    mirror = np.where(wet, 1.0, 2.0)[None, :, None]
    rate = (mirror * parts["g"] * (v[:, None] - v[None])).sum(axis=(1, 2))
    s = np.maximum(given["completed_ratio"], 0.5)
    return parts["V"] / s * 1000 * (rate / s / DT + 0.02 * np.minimum(0, s - 1) / DT**2)


def matrix_viscous(parts, gamma, wall=TUPLES["viscous"][1]["wall"]):
    """Return A (3n, 3n), its part K, D (n, 3n) of free particles, and who is free."""
    given, role, d, n = parts["given"], parts["role"], parts["d"], len(parts["role"])
    free, mu = role == FREE, given["viscosity"]
    both = mu[:, None] + mu[None]
    mean = np.where(mu[None] > 0, 2 * np.outer(mu, mu) / np.where(both > 0, both, 1), wall * mu[:, None])
    k = parts["strength"] * mean * np.outer(parts["V"], parts["V"]) * parts["F"] / (parts["r"] ** 2 + 1e-4 * H**2)
    K = np.zeros((n, 3, n, 3))
    block = k[:, :, None, None] * d[..., :, None] * d[..., None, :]  # (i, j, a, b)
    K -= block.transpose(0, 2, 1, 3)
    K[np.arange(n), :, np.arange(n)] += block.sum(axis=1)
    D = np.zeros((n, n, 3))
    D += parts["g"]
    D[np.arange(n), np.arange(n)] -= parts["g"].sum(axis=1)
    D[~free] = 0.0
    D = D.reshape(n, 3 * n)
    K = K.reshape(3 * n, 3 * n)
    A = K + np.diag(np.repeat(given["mass"], 3) / DT) + D.T @ ((gamma * mu * parts["V"])[:, None] * D)
    return A, K, D, free


def apply_viscous(a, changes, direction, gamma, backend="cpu"):
    """Return A d (3, n) by the stages."""
    a["viscous_direction"] = np.ascontiguousarray(direction, dtype=a["mass"].dtype)
    if gamma:
        run("dilation", backend, a, gamma=gamma, renamed={"velocity": "viscous_direction"}, **changes)
    return run("viscous_apply", backend, a, dt=DT)["viscous_product"]


def solve(a, first, names, backend, rtol, limit=1000):
    """Run conjugate gradients to ||r|| <= rtol ||b||; return the iterations."""
    sums, apply, step, turn = names
    first()
    for iteration in range(limit):
        rows = a[sums].sum(axis=1)
        if rows[3] <= rtol**2 * rows[4]:
            return iteration
        apply()
        run(step, backend, a)
        run(turn, backend, a)
    raise AssertionError("no convergence")


def solve_viscous(a, changes, gamma, backend="cpu", rtol=1e-10):
    """Solve A v = b from the first guess in ``velocity``; return the iterations."""

    def first():
        if gamma:
            run("dilation", backend, a, gamma=gamma, **changes)
        run("viscous_start", backend, a, dt=DT)

    def apply():
        apply_viscous(a, changes, a["viscous_direction"], gamma, backend)

    if not gamma:
        a["dilation"], a["viscous_pressure"] = a["dilation"][:0], a["viscous_pressure"][:0]
    return solve(a, first, ("viscous_sums", apply, "viscous_step", "viscous_turn"), backend, rtol)


def scipy_iterations(A, b, x0, inverse, limit):
    """Return the iterations of SciPy's conjugate gradients to ||r|| <= limit."""
    count = [0]

    def called(_):
        count[0] += 1

    _, info = cg(A, b, x0=x0, rtol=0.0, atol=limit, M=LinearOperator(A.shape, inverse), callback=called, maxiter=2000)
    assert info == 0
    return count[0]


@kinds
def test_poisson_matrix_is_the_assembled_one_and_symmetric(kind):
    a, changes, parts = scene(kind)
    S, act = matrix_poisson(parts)
    run("poisson_pairs", "cpu", a, **changes)
    assert a["poisson_diagonal"] == pytest.approx(S.diagonal(), rel=1e-12)
    rng = np.random.default_rng(0)
    u, v = (np.where(act, rng.normal(size=len(act)), 0.0) for _ in range(2))
    products = []
    for d in (u, v):
        a["poisson_direction"] = d
        products.append(run("poisson_apply", "cpu", a)["poisson_product"].copy())
        assert products[-1] == pytest.approx(S @ d, rel=1e-12, abs=1e-12 * abs(S.diagonal()).max())
    assert u @ products[1] == pytest.approx(v @ products[0], rel=1e-12)
    assert u @ products[0] > 0


@kinds
def test_poisson_solution_and_iterations_are_those_of_scipy(kind):
    a, changes, parts = scene(kind)
    S, act = matrix_poisson(parts)
    b = np.where(S.diagonal() > 0, right_poisson(parts, S.diagonal() > 0), 0.0)
    wet = np.flatnonzero(S.diagonal() > 0)
    run("poisson_pairs", "cpu", a, **changes)
    n = solve(
        a, lambda: run("poisson_start", "cpu", a, dt=DT, shift=0.0, **changes),
        ("poisson_sums", lambda: run("poisson_apply", "cpu", a), "poisson_step", "poisson_turn"), "cpu", 1e-10,
    )
    assert a["poisson_sums"][4].sum() == pytest.approx(b @ b, rel=1e-12)
    inner = S[wet][:, wet].tocsc()
    exact = spsolve(inner, b[wet])
    assert np.linalg.norm(a["poisson_pressure"][wet] - exact) < 1e-8 * np.linalg.norm(exact)
    assert not np.delete(a["poisson_pressure"], wet).any()
    diagonal = inner.diagonal()
    expected = scipy_iterations(inner, b[wet], np.zeros(len(wet)), lambda r: r / diagonal, 1e-10 * np.linalg.norm(b))
    assert abs(n - expected) <= max(1, 0.1 * expected), (n, expected)


@kinds
@pytest.mark.parametrize("gamma", (0.0, 10.0))
def test_viscous_matrix_is_the_assembled_one_and_symmetric(kind, gamma):
    a, changes, parts = scene(kind)
    A, K, D, free = matrix_viscous(parts, gamma)
    run("pair_shear", "cpu", a, dt=DT, gamma=gamma, **changes)
    assert np.array_equal(a["viscous_block"][0] > 0, free)
    n = len(free)
    for i in np.flatnonzero(free):
        six = a["viscous_block"][:, i]
        B = np.array([[six[0], six[3], six[4]], [six[3], six[1], six[5]], [six[4], six[5], six[2]]])
        assert B @ A[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] == pytest.approx(np.eye(3), abs=1e-10)
    rng = np.random.default_rng(0)
    u, v = (np.where(free, rng.normal(size=(3, n)), 0.0) for _ in range(2))
    if not gamma:
        a["dilation"] = a["dilation"][:0]
    products = []
    for d in (u, v):
        got = apply_viscous(a, changes, d, gamma)
        expected = np.where(free, (A @ d.T.ravel()).reshape(n, 3).T, 0.0)
        assert got == pytest.approx(expected, rel=1e-12, abs=1e-12 * abs(expected).max())
        products.append(got.copy())
    assert (u * products[1]).sum() == pytest.approx((v * products[0]).sum(), rel=1e-12)
    assert (u * products[0]).sum() > 0


@pytest.mark.parametrize("kind", ("3d", "2d"))
@pytest.mark.parametrize("backend", BACKENDS)
def test_rigid_motion_meets_no_viscosity(kind, backend):
    a, changes, parts = scene(kind)
    run("pair_shear", backend, a, dt=DT, **changes)
    x = parts["given"]["position"].T
    spin = np.array([0.0, 2.0, 0.0]) if kind == "2d" else np.array([1.0, 2.0, -3.0])
    a["viscous_direction"] = np.ascontiguousarray(np.cross(spin, x).T + np.array([[1.0], [0.0], [2.0]]))
    a["mass"] = np.zeros_like(a["mass"])  # leaves K alone
    a["dilation"] = a["dilation"][:0]
    force = run("viscous_apply", backend, a, dt=DT)["viscous_product"]
    scale = (a["pair_shear"] ** 2).sum(axis=(0, 2)).max() * abs(a["viscous_direction"]).max()
    assert abs(force).max() < 1e-12 * scale


@kinds
@pytest.mark.parametrize("gamma", (0.0, 10.0))
def test_viscous_solution_and_iterations_are_those_of_scipy(kind, gamma):
    a, changes, parts = scene(kind)
    A, K, D, free = matrix_viscous(parts, gamma)
    given, rng, n = parts["given"], np.random.default_rng(5), len(free)
    pressure = np.where(free, rng.normal(size=n) * 100, 0.0) if gamma else np.zeros(n)
    a["velocity_free"], a["viscous_pressure"] = a["velocity"].copy(), pressure.copy()
    run("pair_shear", "cpu", a, dt=DT, gamma=gamma, **changes)
    iterations = solve_viscous(a, changes, gamma)

    rows = np.repeat(free, 3)
    v = given["velocity"].T.ravel()
    own = np.repeat(given["mass"], 3) / DT * v
    b = (own + D.T @ (parts["V"] * pressure) - A[:, ~rows] @ v[~rows])[rows]
    inner = sparse.csc_matrix(A[np.ix_(rows, rows)])
    exact = spsolve(inner, b)
    got = a["velocity"].T.ravel()
    assert np.linalg.norm(got[rows] - exact) < 1e-8 * np.linalg.norm(exact)
    assert np.array_equal(got[~rows], v[~rows])
    assert a["viscous_sums"][4].sum() == pytest.approx((own[rows] ** 2).sum(), rel=1e-12)
    blocks = np.linalg.inv(np.array([A[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] for i in np.flatnonzero(free)]))
    expected = scipy_iterations(
        inner, b, v[rows], lambda r: np.einsum("iab,ib->ia", blocks, r.reshape(-1, 3)).ravel(), 1e-10 * np.linalg.norm(own[rows])
    )
    assert abs(iterations - expected) <= max(1, 0.1 * expected), (iterations, expected)


@kinds
@pytest.mark.parametrize("backend", BACKENDS[1:])
def test_pairs_agree_to_the_last_bit_from_both_sides(kind, backend):
    """Then momentum is kept to rounding, and the matrices are symmetric in float32 too."""
    a, changes, parts = scene(kind, "single")
    run("pair_shear", backend, a, dt=DT, gamma=10, **changes)
    run("poisson_pairs", backend, a, **changes)
    place = {(i, int(j)): k for i, row in enumerate(a["neighbour_index"]) for k, j in enumerate(row[: a["neighbour_count"][i]])}
    free, seen = parts["role"] == FREE, 0
    for (i, j), k in place.items():
        if free[i] and free[j]:
            back = place[j, i]
            assert np.array_equal(a["pair_shear"][:, i, k], -a["pair_shear"][:, j, back])
            assert a["pair_poisson"][i, k] == a["pair_poisson"][j, back]
            seen += a["pair_poisson"][i, k] > 0
    assert seen > 1000


@kinds
@pytest.mark.parametrize("gamma", (0.0, 10.0))
def test_viscosity_keeps_momentum_and_takes_energy(kind, gamma):
    """Free liquid alone: nothing given to push against."""
    a, changes, parts = scene(kind)
    run("pair_shear", "cpu", a, dt=DT, gamma=gamma, wall=0.0, **changes)
    for i in np.flatnonzero(parts["role"] != FREE):  # out of all pairs
        hits = a["neighbour_index"] == i
        a["pair_shear"][:, hits] = 0
        a["pair_gradient"][:, hits] = 0
    a["velocity_free"] = a["velocity"].copy()
    before, mass, free = a["velocity"].copy(), a["mass"], parts["role"] == FREE
    solve_viscous(a, changes, gamma)
    change = (mass * (a["velocity"] - before))[:, free]
    assert abs(change.sum(axis=1)).max() < 1e-9 * abs(mass * before).sum()
    energy = [(mass * v**2)[:, free].sum() for v in (a["velocity"], before)]
    assert energy[0] < 0.9 * energy[1]


@pytest.mark.parametrize("backend", BACKENDS)
def test_stages_agree_in_a_whole_solve(backend):
    """The same number of iterations and the same flow on each backend, in float64."""
    a, changes, _ = scene("3d")
    a["velocity_free"] = a["velocity"].copy()
    run("pair_shear", backend, a, dt=DT, gamma=10, **changes)
    n = solve_viscous(a, changes, 10.0, backend, 1e-6)
    one, changes, _ = scene("3d")
    one["velocity_free"] = one["velocity"].copy()
    run("pair_shear", "cpu", one, dt=DT, gamma=10, **changes)
    assert abs(solve_viscous(one, changes, 10.0, "cpu", 1e-6) - n) <= 1
    assert a["velocity"] == pytest.approx(one["velocity"], abs=1e-5)


def test_multiplier_drives_the_flow_to_no_divergence():
    """p -= gamma D v: each outer iteration takes some of what is left of D v."""
    a, changes, _ = scene("3d")
    a["velocity_free"] = a["velocity"].copy()
    run("pair_shear", "cpu", a, dt=DT, gamma=10, **changes)
    left = []
    for _ in range(3):
        solve_viscous(a, changes, 10.0, rtol=1e-4)
        run("dilation", "cpu", a, gamma=10, **changes)
        run("viscous_keep", "cpu", a)
        left.append(np.linalg.norm(a["dilation"]))
    assert left[1] < 0.7 * left[0] and left[2] < 0.85 * left[1], left
