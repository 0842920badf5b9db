"""Fields and parameters of incompressible and viscous liquids for the check scene, by NumPy alone."""

import numpy as np

from melt.check._cloud import CELL, INACTIVE, LIQUID, SOLID, SPACING, SUPPORT

#: Files of stages that are checked with these fields in place of those of the position based fluid.
FILES = {
    "periodic", "slime_motion", "pairs", "dfsph_source", "dfsph", "poisson", "poisson_cg", "viscosity_law", "viscous", "viscous_cg",
    "ghosts", "ghost_sums", "apic_weights", "apic_nodes", "apic_back", "apic_stress", "apic_emit", "surface_pressure", "load",
}
VOLUME = SPACING**3
APICS, GHOST_SLOTS = 601, 4000
EDGE = 4  # ghost candidates along a cell edge: pitch and cell edge are exact
PERIOD = dict(
    length_x=0.0, length_y=0.0, length_z=0.0, inverse_x=0.0, inverse_y=0.0, inverse_z=0.0, lower_x=0.0, lower_y=0.0, lower_z=0.0
)
DFSPH = dict(omega=0.5, warm=0.5, warm_limit=10.0, fewest=20, least=1e-6 / SUPPORT**2)
POISSON = dict(rest_density=1000.0, floor=1e-4 * SUPPORT**2, pull=0.02, full_share=0.85, clamp=0, full=60.0)
VISCOUS = dict(
    law=1, mu=50.0, slope=3000.0, reference_temperature=20.0, power=0.7, yield_stress=5.0, yield_rate=10.0, smallest=1.0,
    largest=400.0, wall=0.8, strength=10.0, floor=1e-4 * SUPPORT**2, gamma=10.0,
)
GHOSTS = dict(
    across=EDGE, flat=0, pitch=CELL / EDGE, distance=0.85 * SPACING, jitter=0.1 * SPACING, fill=0.5, volume=VOLUME, plane=0.0,
    seed_low=12345, seed_high=-7,
)
APIC = dict(
    support=SUPPORT, kernel=0, dimension=3, affine=1, literal=0, flip=0.1, rank=1e-3 * SUPPORT**2, orphan=1e-3 * 8 / (np.pi * SUPPORT**3),
    massless=1e-12 * 1000 * VOLUME, most=1.1 * VOLUME, rest_density=1000.0,
)
ELASTIC = dict(modulus=300.0, relaxation=0.5, dimension=3)
SCALES = dict(
    inverse_spacing=1 / SPACING,
    inverse_area=1 / SPACING**2,
    dfsph_factor=1000 * VOLUME * SPACING**2 / VOLUME,
    impulse=1e4 * 1e-6,
    poisson=1e4 * SPACING,
    poisson_sums=(2e3 * SPACING) ** 2,  # a residual is what larger terms leave, and the sums are of its squares
    viscosity=50.0,
    pair_shear=np.sqrt(50.0 * SPACING),
    viscous_block=1e-3 / (1000 * VOLUME),
)


def _gradients(arrays):
    """Return pair_gradient (3, n, m) of the cubic spline, density_ratio and the rows of the lists."""
    x, index, count = arrays["position"], arrays["neighbour_index"], arrays["neighbour_count"]
    n, m = index.shape
    on = np.arange(m)[None, :] < count[:, None]
    j = np.where(on, index, 0)
    d = x[:, :, None] - x[:, j] if n else np.zeros((3, 0, m))
    r = np.sqrt((d**2).sum(axis=0))
    q = np.minimum(r / SUPPORT, 1.0)
    s = 8 / (np.pi * SUPPORT**3)
    W = s * np.where(q < 0.5, 6 * q**3 - 6 * q**2 + 1, 2 * (1 - q) ** 3)
    dW = s / SUPPORT * np.where(q < 0.5, 18 * q**2 - 12 * q, -6 * (1 - q) ** 2)
    V = arrays["volume"]
    near = on & (r > 1e-9 * SUPPORT)
    g = np.where(near, V[j] * dW / np.where(near, r, 1.0), 0.0) * d
    ratio = V * s + np.where(on, V[j] * W, 0.0).sum(axis=1)
    return g, ratio, on, j, r


def fields(arrays, rng):
    """Return the fields of a step in the making: operators that fit the positions, random states."""
    phase, V = arrays["phase"], arrays["volume"]
    n, liquid, solid = len(phase), phase == LIQUID, phase == SOLID
    g, ratio, on, j, r = _gradients(arrays)
    held = np.where(liquid & (rng.random(n) < 0.1), 1, 0)
    mass = np.where(arrays["mass"] > 0, arrays["mass"], 1.0)
    mobility = np.where((liquid & (held == 0)) | solid, 1 / mass, 0.0)
    own = (g**2).sum(axis=0)
    D = arrays["volume"] * (mobility * (g.sum(axis=2) ** 2).sum(axis=0) + np.where(on, mobility[j] * own, 0.0).sum(axis=1))
    factor = np.where(liquid & (held == 0) & (D > 1e-6 / mass / SUPPORT**2), 1 / np.where(D > 0, D, 1.0), 0.0)
    act = factor > 0
    completed = np.where(liquid, np.minimum(np.maximum(ratio, 1.0), ratio + 0.2 * rng.random(n)), 1.0)
    Vc = V / np.maximum(completed, 0.5)
    both = on & act[:, None] & act[j]
    s_ij = np.where(both, 2 * Vc[:, None] * Vc[j] * np.sqrt(own) * r / np.where(V[j] > 0, V[j], 1.0) / (r**2 + 1e-4 * SUPPORT**2), 0.0)
    ghost = np.where(liquid & (rng.random(n) < 0.3), rng.uniform(0, 20, n), 0.0)
    diagonal = np.where(act, s_ij.sum(axis=1) + 4 * Vc * ghost, 0.0)
    mu = np.where(liquid, rng.uniform(5, 200, n), 0.0)
    d = arrays["position"][:, :, None] - arrays["position"][:, j] if n else np.zeros_like(g)
    pair_mu = np.where(act[j], 2 * mu[:, None] * mu[j] / np.maximum(mu[:, None] + mu[j], 1e-30), 0.8 * mu[:, None])
    F = np.sqrt(own) / np.where(V[j] * r > 0, V[j] * r, 1.0)
    w = np.where(on & act[:, None], np.sqrt(10 * pair_mu * V[:, None] * V[j] * F / (r**2 + 1e-4 * SUPPORT**2)), 0.0) * d
    return dict(
        held=held,
        mobility=mobility,
        pair_gradient=g,
        density_ratio=np.where(liquid, ratio, np.where(phase == INACTIVE, 0.0, 1.0)),
        completed_ratio=completed,
        dfsph_factor=factor,
        compression_source=np.where(act, rng.normal(size=n) * 0.05, 0.0),
        solver_pressure=np.where(act, np.maximum(rng.normal(size=n), 0) * 3e3, 0.0),
        pressure_last=np.where(act, np.maximum(rng.normal(size=n), 0) * 3e3, 0.0),
        pressure_acceleration=np.where(mobility > 0, rng.normal(size=(3, n)) * 20.0, 0.0),
        density_impulse=np.where(act, np.maximum(rng.normal(size=n), 0) * 5e-3, 0.0),
        divergence_impulse=np.where(act, np.maximum(rng.normal(size=n), 0) * 5e-3, 0.0),
        surface_normal=_normals(act, g),
        surface_pressure=np.where(act & (rng.random(n) < 0.3), rng.normal(size=n) * 500.0, 0.0),
        **_poisson(act, s_ij, diagonal, Vc, ghost, rng),
        viscosity=mu,
        shear_rate=np.where(liquid, rng.uniform(0, 30, n), 0.0),
        pair_shear=w,
        viscous_block=_blocks(act, w, mass, rng),
        velocity_free=arrays["velocity"] + 0.1 * rng.normal(size=(3, n)),
        dilation=np.where(act, rng.normal(size=n) * 100.0, 0.0),
        viscous_pressure=np.where(act, rng.normal(size=n) * 100.0, 0.0),
        viscous_residual=np.where(act, rng.normal(size=(3, n)), 0.0),
        viscous_direction=np.where(act, rng.normal(size=(3, n)), 0.0),
        viscous_product=np.where(act, rng.normal(size=(3, n)), 0.0),
        viscous_sums=rng.uniform(0.5, 1.5, (5, 64)),
        position_kept=arrays["position"] + 0.01 * SPACING * rng.normal(size=(3, n)),
        velocity_kept=arrays["velocity"] + 0.1 * rng.normal(size=(3, n)),
        node_state=np.where(liquid & (rng.random(n) < 0.05), 1, 0),
    )


def _poisson(act, s_ij, diagonal, Vc, ghost, rng):
    """Return the fields of the pressure Poisson equation."""
    n = len(act)
    return dict(
        pair_poisson=s_ij,
        poisson_ghost=np.where(act, 4 * Vc * ghost, 0.0),
        poisson_diagonal=diagonal,
        poisson_pressure=np.where(act, rng.normal(size=n) * 3e3, 0.0),
        poisson_residual=np.where(act, rng.normal(size=n), 0.0),
        poisson_direction=np.where(act, rng.normal(size=n) * 1e3, 0.0),
        poisson_product=np.where(act, rng.normal(size=n), 0.0),
        poisson_sums=rng.uniform(0.5, 1.5, (5, 64)),
        ghost_laplacian=ghost,
    )


def _normals(act, g):
    """Return unit normals of particles near the surface (3, n)."""
    G = g.sum(axis=2)
    size = np.sqrt((G**2).sum(axis=0))
    return np.where(act & (size * SUPPORT > 0.1), G / np.where(size > 0, size, 1.0), 0.0)


def _blocks(act, w, mass, rng):
    """Return the inverse of m/dt + sum w w^T per particle (6, n), 0 where the velocity is given."""
    n = len(act)
    A = np.einsum("aik,bik->iab", w, w) + (mass / 1e-3)[:, None, None] * np.eye(3)
    inverse = np.linalg.inv(A) if n else np.zeros((0, 3, 3))
    six = np.stack([inverse[:, a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]) if n else np.zeros((6, 0))
    return np.where(act, six, 0.0)


def sizes(grid):
    """Return the sizes of the extents that only these stages have."""
    return dict(apic=APICS, ghost=GHOST_SLOTS, ghost_point=grid["nx"] * grid["ny"] * grid["nz"] * EDGE**3, driver=2, nozzle=1, offset=8)
