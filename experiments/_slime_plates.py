"""Viscous flows with series or exponentials for solutions: Couette and Poiseuille start-up, Taylor-Green, a film on an incline."""

import math

import numpy as np
from scipy.spatial import cKDTree

from experiments._slime_runs import energy, liquid, settings_of, start, to
from melt.slime.exact import couette, poiseuille

H, NU, SPEED, FORCE = 0.01, 1e-3, 0.1, 8.0  # of the scenes couette and poiseuille
INSTANTS = (0.01, 0.02, 0.05, 0.1)
NOISY = 0.25  # jitter of a disordered start in spacings


def start_up(kind, across, *settings, end=INSTANTS[-1]):
    """Return L2 errors of the velocity at `INSTANTS`, the largest of them, and the ratio of speeds at the end."""
    exact, drive = {"couette": (couette, SPEED), "poiseuille": (poiseuille, FORCE)}[kind]
    sim = start(kind, f"domain.spacing={H / across}", *settings)
    errors, tally, ratio = [], {}, 0.0
    for instant in (t for t in INSTANTS if t <= end):
        found = to(sim, instant)
        tally = {k: tally.get(k, 0) + v * (found["sub_steps"] if "iterations" in k else 1) for k, v in found.items()}
        q = liquid(sim)
        wanted = exact(q.x[:, 1], sim.time, H, NU, drive)
        errors.append(float(np.sqrt(((q.v[:, 0] - wanted) ** 2).sum() / (wanted**2).sum())))
        ratio = float((q.v[:, 0] * wanted).sum() / (wanted**2).sum())
    tally = {k: v / tally["sub_steps"] if "iterations" in k else v for k, v in tally.items()}
    return {"errors": np.array(errors), "L2": errors[-1], "worst": max(errors), "ratio": ratio,
            "seconds": tally["seconds"], "settings": settings_of(sim, tally)}


def vortices(*settings, end=0.2):
    """Return the decay rate of Taylor-Green vortices in units of the exact one, by energy and by projection on the flow."""
    sim = start("taylor_green", *settings)
    k, times, kinetic, share = 2 * np.pi, [], [], []

    def watch(sim):
        q = liquid(sim)
        flow = np.stack([np.cos(k * q.x[:, 0]) * np.sin(k * q.x[:, 1]), -np.sin(k * q.x[:, 0]) * np.cos(k * q.x[:, 1])], axis=1)
        times.append(sim.time)
        kinetic.append(energy(q.m, q.v))
        share.append(float((q.m[:, None] * q.v * flow).sum() / (q.m[:, None] * flow**2).sum()))

    watch(sim)
    found = to(sim, end, watch)
    nu, dt = sim.scene.viscosity.mu / sim.scene.fluid.density, sim.scene.time.dt
    exact = 2 * k**2 * nu
    rate = -np.polyfit(times, np.log(kinetic), 1)[0] / 2
    out = {"rate": rate / exact, "rate_of_flow": -np.polyfit(times, np.log(share), 1)[0] / exact,
           # backward Euler makes (1 + a dt) of exp(a dt)
           "step_error": math.log1p(exact * dt) / (exact * dt), "seconds": found["seconds"], "settings": settings_of(sim, found)}
    if sim.scene.solver.apic is not None:  # slime spec 2.5: a round trip keeps exp(-s) (1 + s) of a wave; |k| = 2 pi sqrt(2)
        s = 0.079 * (sim.scene.solver.apic.support * sim.scene.support) ** 2 * 2 * k**2
        out["transfers"] = (s - math.log1p(s)) / dt / exact
    return out


def operator(*settings, end=0.2):
    """Return what the pair forces dissipate over 2 mu E:E where Taylor-Green vortices have taken the particles.

    In their own flow, in a shear wave, in uniform shear and extension along the axes, and in the mean over all directions.
    """
    sim = start("taylor_green", *settings)
    found = to(sim, end)
    x, h, V = liquid(sim).x, sim.scene.support, sim.scene.spacing**2
    pair = cKDTree(x % 1.0, boxsize=1.0).query_pairs(h, output_type="ndarray")
    d = x[pair[:, 0]] - x[pair[:, 1]]
    d -= np.round(d)
    r2 = (d**2).sum(axis=1)
    q = np.sqrt(r2) / h
    slope = 40 / (7 * np.pi * h**3) * np.where(q <= 0.5, 12 * q - 18 * q**2, 6 * (1 - q) ** 2)
    weight = 8 * slope / np.sqrt(r2) / (r2 + sim.scene.viscosity.floor * h**2) * V**2
    k = 2 * np.pi

    def share(v, exact):
        along = ((v[pair[:, 0]] - v[pair[:, 1]]) * d).sum(axis=1)
        return float((weight * along**2).sum() / (exact * V * (v**2).sum()))

    own = np.stack([np.cos(k * x[:, 0]) * np.sin(k * x[:, 1]), -np.sin(k * x[:, 0]) * np.cos(k * x[:, 1])], axis=1)
    wave = np.stack([np.sin(k * x[:, 1]), np.zeros(len(x))], axis=1)
    shear = float((weight * (d[:, 0] * d[:, 1]) ** 2).sum())
    stretch = float((weight * (d[:, 0] ** 2 - d[:, 1] ** 2) ** 2).sum() / 4)
    out = {"own": share(own, 2 * k**2), "wave": share(wave, k**2), "shear": shear, "extension": stretch, "mean": (shear + stretch) / 2}
    return out | {"seconds": found["seconds"], "settings": settings_of(sim, found) if end else "the lattice of the start"}


def film(across=20, slope=0.1, *settings):
    """Return the surface speed of a film on an incline over rho g sin(a) H^2/(2 mu) (periodic, gravity tilted), after H^2/nu."""
    g = 9.81
    sim = start("poiseuille", f"domain.spacing={H / across}", f"domain.gravity=[{g * math.sin(slope)}, 0.0, {-g * math.cos(slope)}]",
                f"domain.upper=[{12 * H / across}, 0.0, {1.5 * H}]", "domain.walls={sides=['floor'], layers=3}",
                f"fluid.fill=[{{lower=[0.0, -1e-3, 0.0], upper=[{12 * H / across}, 1e-3, {H}]}}]", *settings)
    found = to(sim, H**2 / NU)
    q = liquid(sim)
    z, depth = q.x[:, 1], q.m.sum() / sim.scene.fluid.density / (12 * H / across)
    nu, a, t = NU, g * math.sin(slope), sim.time
    n = (2 * np.arange(200) + 1)[:, None]
    half = a / (2 * nu) * z * (2 * depth - z) - (16 * a * depth**2 / (nu * np.pi**3 * n**3) * np.sin(n * np.pi * z / (2 * depth))
                                                 * np.exp(-nu * (n * np.pi / (2 * depth)) ** 2 * t)).sum(axis=0)
    top = z > depth - 1.5 * H / across
    return {"ratio": float(q.v[top, 0].mean() / half[top].mean()), "L2": float(np.sqrt(((q.v[:, 0] - half) ** 2).sum() / (half**2).sum())),
            "depth": depth, "seconds": found["seconds"], "settings": settings_of(sim, found)}
