"""Heat and melting fronts of particles at rest against analytic solutions and gallium (V2-V9).

Every case returns rows (case, truth, measured, tolerance); tolerance is absolute, in the unit of the truth.
``size`` scales cross-section and length: 1 is the full case, tests take less. The order of pair sweeps is held
against Strang splitting's 2; eq (4) steps each pair by backward Euler, which is of order 1 with a small constant.
"""

import math
import time

import h5py
import numpy as np
from scipy.linalg import expm
from scipy.special import erf

from experiments import Row, claiming
from experiments._heat_fronts import gallium, stefan, two_phase
from experiments._heat_slab import Slab
from melt import params as P


def halves(solver="pairs_coloured", half_width=12, depth=3.0, conductivity=0.5, dt=0.005, **options):
    """V2: halves at -1 and +1: T = erf(x / (2 sqrt(alpha t))) at sqrt(alpha t) = ``depth`` dx."""
    dx, alpha = 0.2, 2 * conductivity
    steps = round((depth * dx) ** 2 / alpha / dt)
    length = 2 * math.ceil(8 * depth)
    middle = length / 2 * dx
    slab = Slab(
        (length, 2 * half_width, 2 * half_width),
        conductivity=(conductivity,),
        solver=solver,
        T0=lambda x: np.where(x[0] < middle, -1.0, 1.0),
        **options,
    )
    x, T = slab.step(dt, steps).column("temperature")
    truth = erf((x - middle) / (2 * math.sqrt(alpha * steps * dt)))
    limit = {P.L_VISC: 0.005}.get(options.get("laplacian", P.L_VISC), 0.013)
    limit = 0.035 if options.get("jitter") else limit
    return [(f"V2 erf {solver}", 0.0, float(np.abs(T - truth).max()), limit)]


def same_matrix(solver="pairs_coloured", conductivity=0.5, dt=0.005, steps=72, shape=(40, 4, 4), **options):
    """V3: against the exact exponential of the same matrix, at sqrt(alpha t) = 3 dx unless told otherwise."""
    dx, brook = 0.2, options.get("laplacian", P.L_VISC) == P.L_BROOK
    slab = Slab(
        shape,
        conductivity=(conductivity,),
        solver=solver,
        T0=lambda x: np.where(x[0] < shape[0] / 2 * dx, -1.0, 1.0),
        **options,
    )
    x, T0 = slab.read("position"), slab.read("temperature")
    h, K, V = 2.5 * dx, conductivity, dx**3
    r = np.sqrt(((x[:, :, None] - x[:, None, :]) ** 2).sum(axis=0))
    L = 45 / (math.pi * h**6) * np.maximum(h - r, 0)
    if brook:  # -2 W'/r of the cubic spline
        q = np.where(r > 0, r, h) / h
        L = 96 / (math.pi * h**5) * np.where(q <= 0.5, 2 - 3 * q, np.maximum(1 - q, 0) ** 2 / q)
    A = 2 * K * V * L
    np.fill_diagonal(A, 0)
    A -= np.diag(A.sum(axis=1))
    truth = expm(A * dt * steps) @ T0
    error = float(np.abs(slab.step(dt, steps).read("temperature") - truth).max())
    limit = 2.5e-3 if solver == "cg" else 3.5e-3 if brook else 1.5e-3
    return [(f"V3 expm {solver}{' L_brook' if brook else ''} Fo {2 * K * dt / dx**2:.3g}", 0.0, error, limit)]


def convergence(solver, coarse=8, time=0.32):
    """V3: halving dt divides the error by 2^order.

    Strang splitting would be of order 2 were each pair exact; eq (4) steps a pair by backward
    Euler, so the order falls from 1.4 (Fo = 1) to 1, with a far smaller constant than cg's.
    """
    errors = [same_matrix(solver, dt=time / n, steps=n, shape=(24, 4, 4))[0][2] for n in (coarse, 2 * coarse)]
    order = math.log2(errors[0] / errors[1])
    truth, bound = (1.0, 0.06) if solver == "cg" else (2.0, 0.25)
    return [(f"V3 order {solver} Fo {time / coarse / 0.04:.3g}", truth, order, bound)]


def contact_temperature(solver="pairs_coloured", half_width=8, steps=180, **options):
    """V4: ice at -10 against water at 40 degC: 11.27 degC at the interface at once and for good."""
    dx, half = 1e-3, 24
    k, rho, c = (0.56, 2.22), (1000.0, 917.0), (4187.0, 2100.0)
    dt = 0.25 * dx**2 / (k[1] / (rho[1] * c[1]))
    slab = Slab(
        (2 * half, 2 * half_width, 2 * half_width),
        spacing=dx,
        law="physical",
        conductivity=k,
        density=rho,
        specific_heat=c,
        latent_heat=(0.0, 0.0),
        melting_point=(math.inf, math.inf),
        solver=solver,
        row=lambda lattice: (lattice[0] < half).astype(int),
        T0=lambda x: np.where(x[0] < half * dx, -10.0, 40.0),
        **options,
    )
    _, T = slab.step(dt, steps).column("temperature")
    effusivity = [math.sqrt(a * b * d) for a, b, d in zip(k, rho, c)]
    truth = (effusivity[0] * 40 + effusivity[1] * -10) / sum(effusivity)
    # equal flux on both sides of the interface, half a spacing from either layer
    measured = (k[1] * T[half - 1] + k[0] * T[half]) / sum(k)
    return [(f"V4 contact temperature {solver}", truth, float(measured), 0.02 * 50)]


def ledger(solver="pairs_coloured", steps=10_000, precision="double", shape=(40, 4, 4), **options):
    """V5: Sum C T + latent energy is constant; without latent heat min T0 <= T <= max T0."""
    rng = np.random.default_rng(5)
    slab = Slab(
        shape,
        conductivity=(0.3,),
        T0=lambda x: rng.uniform(-10, 40, x.shape[1]),
        jitter=0.2,
        solver=solver,
        precision=precision,
        **options,
    )
    T0 = slab.read("temperature")
    before, size = slab.energy(), float(np.sum(slab.read("heat_capacity") * np.abs(T0 - T0.mean())))
    slab.step(0.005, steps)
    T = slab.read("temperature")
    outside = max(0.0, float(T.max() - T0.max()), float(T0.min() - T.min()))
    limit = 1e-12 if precision == "double" else 1e-5
    name = f"V5 {solver} {precision}" + (" latent" if options.get("latent") else "")
    rows = [(f"{name}: energy drift", 0.0, abs(slab.energy() - before) / size, limit)]
    return rows + [(f"{name}: out of bounds [K]", 0.0, outside, 0.0 if solver.startswith("pairs") else limit * 50)]


def uniform_end(scene, size=1.0, latent=False, **options):
    """V6: an insulated mixture ends at the lumped balance; counts and temperatures of F4, F5, F6."""
    water, solid, hot, cold, plain, icy = {
        "F4": (35000, 4913, 40.0, -10.0, 33.85, 25.8),
        "F5": (48500, 12000, 80.0, -20.0, 60.17, 48.6),
        "F6": (40500, 20000, 100.0, -10.0, 63.64, 42.4),
    }[scene]
    n = round((size * (water + solid)) ** (1 / 3))
    total = n**3
    ice = round(total * solid / (water + solid))
    where = np.random.default_rng(6).permutation(total)
    frozen = np.zeros(total, bool)
    frozen[where[:ice]] = True
    ice_mass, c, L = 0.917, (4187.0, 2050.0), 334e3
    common = dict(T0=lambda x: np.where(frozen, cold, hot), solver="cg", row=lambda lattice: frozen.astype(int))
    if latent:
        common |= dict(
            law="physical",
            spacing=1e-3,
            conductivity=(0.56, 2.22),
            specific_heat=c,
            density=(1000.0, 917.0),
            latent_heat=(0.0, L),
            melting_point=(math.inf, 0.0),
            latent=True,
            phase=lambda lattice: frozen.astype(int),
        )
        truth = ((total - ice) * hot * c[0] - ice * ice_mass * (L - cold * c[1])) / (
            c[0] * (total - ice + ice_mass * ice)
        )
    else:
        common |= dict(
            conductivity=(0.5, 0.5),
            specific_heat=(1.0, 1.0),
            density=(1.0, 1.0),
            latent_heat=(0.0, 0.0),
            melting_point=(math.inf, math.inf),
        )
        truth = ((total - ice) * hot + ice * cold) / total
    slab = Slab((n, n, n), **common, **options)
    dt = (10.0 if latent else 20.0) * slab.spacing**2 / slab.alpha
    for _ in range(400):
        slab.step(dt, 4)
        T = slab.read("temperature")
        if np.ptp(T) < 1e-7:
            break
    published = icy if latent else plain
    name = f"V6 {scene}" + (" with latent heat" if latent else "")
    return [
        (f"{name}: mean", truth, float(T.mean()), 1e-6 * abs(truth)),
        (f"{name}: spread", 0.0, float(np.ptp(T)), 1e-6),
        (f"{name}: published", published, float(T.mean()), 0.15 if size == 1.0 else 0.5),
    ]


def melt_depth(hot=40.0, cold=-10.0, times=(0.5, 1.0, 2.0, 4.0), half_width=10, solver="pairs_coloured", **options):
    """V7: where T = 0 stands without latent heat, same K: 2 erfinv(T_mean/T_half) sqrt(alpha t)."""
    from scipy.special import erfinv

    dx, K, dt = 0.2, 0.3, 0.005
    half = math.ceil(5 * math.sqrt(2 * K * max(times)) / dx)
    slab = Slab(
        (2 * half, 2 * half_width, 2 * half_width),
        conductivity=(K,),
        solver=solver,
        T0=lambda x: np.where(x[0] < half * dx, cold, hot),
        **options,
    )
    factor = 2 * erfinv((hot + cold) / (hot - cold))
    rows, now = [], 0.0
    for t in times:
        slab.step(dt, round((t - now) / dt))
        now = t
        x, T = slab.column("temperature")
        depth = half * dx - float(np.interp(0.0, T, x))
        rows.append((f"V7 {hot:g}/{cold:g} degC at {t:g} s [dx]", factor * math.sqrt(2 * K * t) / dx, depth / dx, 1.0))
    return rows


def cases():
    """Return the functions of all cases, smallest first."""
    return [
        *[lambda s=s: same_matrix(s) for s in ("pairs_coloured", "pairs_seq", "cg")],
        lambda: same_matrix(laplacian=P.L_BROOK),
        *[lambda s=s, n=n: convergence(s, n) for s in ("pairs_coloured", "pairs_seq", "cg") for n in (8, 64)],
        contact_temperature,
        halves,
        lambda: halves("cg"),
        lambda: halves(laplacian=P.L_BROOK),
        lambda: halves(jitter=0.2),
        lambda: halves(precision="single"),
        *[lambda f=f, w=w: uniform_end(f, latent=w) for w in (False, True) for f in ("F4", "F5", "F6")],
        *[lambda T=T: melt_depth(*T) for T in ((40.0, -10.0), (80.0, -20.0), (100.0, -10.0))],
        gallium,
        *[lambda n=n: stefan(n) for n in (2.0, 1.0, 0.5, 0.25, 0.1)],
        lambda: two_phase(0, 0, equal=(1.0, 0.25)),
        lambda: two_phase(0, 0, equal=(0.5, 0.125)),
        # ice conducts 8 times better than water: a slab that the cold wave does not cross is long
        *[
            lambda T=T: two_phase(*T, layers=6, half_width=6, fourier=0.8)
            for T in ((40.0, -10.0), (80.0, -20.0), (100.0, -10.0))
        ],
        *[lambda s=s, p=p: ledger(s, precision=p) for s in ("pairs_coloured", "cg") for p in ("double", "single")],
    ]


def run(out, quick=False, say=print):
    """Run all cases (``quick``: the first ten); what is done is in ``out`` after every case."""
    rows = []
    for case in cases()[: 10 if quick else None]:
        start = time.perf_counter()
        found = case()
        for name, truth, measured, tolerance in found:
            mark = "ok  " if abs(measured - truth) <= tolerance else "MISS"
            say(f"{mark} {name:48s} truth {truth:.6g} measured {measured:.6g} tolerance {tolerance:.2g}")
        rows += [(*row, time.perf_counter() - start) for row in found]
        with h5py.File(out, "w") as file:
            file["name"] = [row[0] for row in rows]
            file["values"] = np.array([row[1:] for row in rows], dtype=float)
            file.attrs["quick"] = quick


def report(path):
    """Return one row per value."""
    with h5py.File(path) as file:
        names, values, quick = [n.decode() for n in file["name"][()]], file["values"][()], file.attrs.get("quick", False)
    rows = [
        Row(name, f"{truth:.6g}", f"{measured:.6g}", f"+- {tolerance:.2g}", bool(abs(measured - truth) <= tolerance))
        for name, (truth, measured, tolerance, _) in zip(names, values)
    ]
    return claiming(rows, quick)
