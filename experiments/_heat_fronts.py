"""Melting fronts of particles at rest against Stefan's and Neumann's solutions, and gallium (spec V8, V9).

Rows as in `experiments.melting_heat`.
"""

import csv
import math
import pathlib

import numpy as np
from scipy.optimize import brentq
from scipy.special import erf, erfc

from experiments._heat_slab import Slab, wall_plane

DATA = pathlib.Path(__file__).parents[1] / "data" / "measured"


def ice(lattice):
    """Return phase or row 1 for every particle."""
    return np.ones(lattice.shape[1], int)


def neumann_one_phase(stefan):
    """Return lambda of lambda exp(lambda^2) erf(lambda) = St / sqrt(pi)."""
    return brentq(lambda a: a * math.exp(a * a) * erf(a) - stefan / math.sqrt(math.pi), 1e-6, 3)


def neumann_two_phase(stefan_liquid, stefan_solid):
    """Return lambda of the two-phase front with equal properties. Front s = 2 lambda sqrt(alpha t)."""

    def balance(a):
        wave = math.exp(-a * a)  # heat from the liquid less heat into the solid melts
        return stefan_liquid * wave / erf(a) - stefan_solid * wave / erfc(a) - a * math.sqrt(math.pi)

    return brentq(balance, 1e-6, 3)


def front_of(x, latent, capacity, spacing):
    """Return how deep has melted: the latent energy of a column over that of one layer."""
    return float(np.sum(latent / capacity)) * spacing


def stefan(number, layers=10, half_width=None, fourier=0.4, solver="pairs_coloured", dx=0.2, K=0.5, **options):
    """V8: one phase, solid at its melting point, wall at 1: s = 2 lambda sqrt(alpha t) at s = ``layers`` dx."""
    lam = neumann_one_phase(number)
    alpha, dt = 2 * K, fourier * dx**2 / (2 * K)
    half_width = half_width or math.ceil(1.2 * layers)
    slab = Slab(
        (math.ceil(1.4 * layers) + 4, 2 * half_width, 2 * half_width),
        spacing=dx,
        conductivity=(K, K),
        latent=True,
        specific_heat=(1.0, 1.0),
        density=(1.0, 1.0),
        latent_heat=(0.0, 1.0 / number),
        melting_point=(math.inf, 0.0),
        phase=ice,
        row=ice,
        walls=3,
        wall_temperature=1.0,
        T0=lambda x: np.zeros(x.shape[1]),
        solver=solver,
        **options,
    )
    plane = wall_plane() * dx
    t = ((layers * dx - plane) / (2 * lam)) ** 2 / alpha
    steps = round(t / dt)
    slab.step(dt, steps)
    x, e, L = slab.column("latent_energy", "latent_capacity")
    measured = front_of(x, e, L, dx) - plane
    truth = 2 * lam * math.sqrt(alpha * steps * dt)
    return [(f"V8 St {number:g} at s = {layers} dx {solver}", 1.0, measured / truth, 0.01)]


def two_phase(hot, cold, layers=10, half_width=None, fourier=0.4, solver="pairs_coloured", equal=None, **options):
    """V9: two phases; ``equal`` = (St_l, St_s) with equal properties, else real ice and water."""
    if equal:
        dx, k, c, law, L, rho = 0.2, (0.5, 0.5), (1.0, 1.0), "paper", 1.0, (1.0, 1.0)
        hot, cold = equal[0], -equal[1]
        lam, alpha = neumann_two_phase(*equal), 1.0
        fastest = 1.0
    else:
        dx, k, c, law, L, rho = 1e-3, (0.56, 2.22), (4187.0, 2050.0), "physical", 334e3, (1000.0, 1000.0)
        alpha, fastest = k[0] / (rho[0] * c[0]), k[1] / (rho[1] * c[1])
        lam = neumann_ice(hot, -cold)
    dt = fourier * dx**2 / fastest
    plane = wall_plane() * dx
    t = ((layers * dx - plane) / (2 * lam)) ** 2 / alpha
    reach = math.ceil((layers * dx + 4 * math.sqrt(fastest * t)) / dx)
    half_width = half_width or math.ceil(1.2 * layers)
    slab = Slab(
        (reach, 2 * half_width, 2 * half_width),
        spacing=dx,
        law=law,
        conductivity=k,
        specific_heat=c,
        density=rho,
        latent_heat=(0.0, L),
        melting_point=(math.inf, 0.0),
        latent=True,
        walls=3,
        wall_temperature=hot,
        phase=ice,
        row=lambda lattice: (lattice[0] >= 0).astype(int),
        T0=lambda x: np.full(x.shape[1], cold),
        solver=solver,
        **options,
    )
    steps = round(t / dt)
    for _ in range(steps):  # conductivity changes with the phase
        slab.step(dt).melt()
    x, e, top = slab.column("latent_energy", "latent_capacity")
    truth = 2 * lam * math.sqrt(alpha * steps * dt)
    return [(f"V9 {hot:g}/{cold:g} s = {layers} dx {solver}", 1.0, (front_of(x, e, top, dx) - plane) / truth, 0.015)]


def neumann_ice(hot, below):
    """Return lambda of the melting front of ice ``below`` K under its melting point, water ``hot`` degC at the wall."""
    k_l, k_s, c_l, c_s, L = 0.56, 2.22, 4187.0, 2050.0, 334e3
    nu = math.sqrt((k_l / c_l) / (k_s / c_s))

    def balance(a):
        liquid = c_l * hot / L * math.exp(-a * a) / erf(a)
        solid = (k_s / k_l) * nu * c_l * below / L * math.exp(-((nu * a) ** 2)) / erfc(nu * a)
        return liquid - solid - a * math.sqrt(math.pi)

    return brentq(balance, 1e-6, 3)


def gallium(layers=60, half_width=10, fourier=0.45, solver="pairs_coloured", **options):
    """Gau & Viskanta 1986, conduction phase: gallium against a wall at 38 degC, initially at 28.3 degC."""
    k, rho, c, L, T_m, width = 32.0, 6093.0, 381.5, 80160.0, 29.78, 0.0889
    dx = width / layers
    depth = layers // 2
    plane = wall_plane() * dx
    slab = Slab(
        (depth, 2 * half_width, 2 * half_width),
        spacing=dx,
        law="physical",
        conductivity=(k, k),
        specific_heat=(c, c),
        density=(rho, rho),
        latent_heat=(0.0, L),
        melting_point=(math.inf, T_m),
        latent=True,
        walls=3,
        wall_temperature=38.0,
        phase=ice,
        row=ice,
        T0=lambda x: np.full(x.shape[1], 28.3),
        solver=solver,
        **options,
    )
    dt, now, rows = fourier * dx**2 / (k / (rho * c)), 0.0, []
    with open(DATA / "gallium_melted_fraction.csv", encoding="utf-8") as file:
        measured = [{key: float(v) for key, v in row.items()} for row in csv.DictReader(file)]
    for point in measured:
        t = 60 * point["minutes"]
        slab.step((t - now) / math.ceil((t - now) / dt), math.ceil((t - now) / dt))
        now = t
        x, e, top = slab.column("latent_energy", "latent_capacity")
        fraction = (front_of(x, e, top, dx) - plane) / width
        name = f"gallium melted fraction at {point['minutes']:g} min"
        rows.append((f"{name}: experiment", point["melted_fraction"], fraction, 0.03))
        rows.append((f"{name}: one-phase Neumann", point["neumann_one_phase"], fraction, 0.03))
    return rows
