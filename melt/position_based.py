"""Scene -> what the position based fluid needs: lattice sums, kernel table, parameter tuples, stability. Boiling 2.0, 2.1."""

import functools
import math
from typing import NamedTuple

import numpy as np

from melt import params as P

POINTS = 1025  # of the kernel table
SHORTEST = 1.5  # R/d of its first point; radii below 1.6 are refused


def _lattice(ratio):
    """Return x (3, n) and r (n,) of the unit lattice within ``ratio``, the origin excluded."""
    reach = math.ceil(ratio)
    x = np.indices((2 * reach + 1,) * 3).reshape(3, -1) - reach
    r = np.sqrt((x**2).sum(axis=0))
    keep = (r > 0) & (r < ratio)
    return x[:, keep].astype(float), r[keep]


class LatticeSums(NamedTuple):
    """Sums of the kernels over the unit lattice. 1 in the continuum."""

    value: float  # S = sum W1, itself included
    gradient: float  # G = -(1/3) sum r dW2/dr
    laplacian: float  # N_L = (1/6) sum r^2 lap W3


def lattice_sums(ratio):
    """Return S, G and N_L of a support of ``ratio`` spacings."""
    _, r = _lattice(ratio)
    R = ratio
    S = 315 / (64 * np.pi * R**9) * (R**6 + ((R**2 - r**2) ** 3).sum())
    G = 45 / (np.pi * R**6) * (r * (R - r) ** 2).sum() / 3
    N_L = 45 / (np.pi * R**6) * (r**2 * (R - r)).sum() / 6
    return LatticeSums(float(S), float(G), float(N_L))


def squared_gradients(ratio):
    """Return D_lat = sum |grad W2|^2 over the unit lattice."""
    _, r = _lattice(ratio)
    return float(((45 / (np.pi * ratio**6) * (ratio - r) ** 2) ** 2).sum())


def kernel_table(ratio):
    """Return `kernel_scale` (2, POINTS) for supports from SHORTEST to ``ratio`` spacings; the last point is exact."""
    ratios = np.linspace(SHORTEST, ratio, POINTS)
    S, G, _ = np.array([lattice_sums(float(q)) for q in ratios]).T
    return np.array([315 / (64 * np.pi * S), 45 / (np.pi * G)])


class Stiffness(NamedTuple):
    """Spectrum of one unrelaxed Jacobi iteration on the lattice."""

    slow: float  # c2: a wave of small k d loses c2 (k d)^2 of its density error
    largest: float  # Lmax: the iteration diverges if omega' Lmax > 2


@functools.lru_cache(maxsize=32)
def stiffness(ratio):
    """Return c2 and Lmax of a support of ``ratio`` spacings.

    A displacement u exp(i k x) gives C = i a.u and takes the correction -b C/(i D): the only eigenvalue is
    L(k) = a.b/D with a = sum grad W1 sin(k x)/S, b the same of W2/G, D = sum |grad W2|^2/G^2.
    """
    x, r = _lattice(ratio)
    sums = lattice_sums(ratio)
    slope1 = 315 / (64 * np.pi * ratio**9) * 6 * (ratio**2 - r**2) ** 2 / sums.value  # -W1'/r
    slope2 = 45 / (np.pi * ratio**6) * (ratio - r) ** 2 / r / sums.gradient
    D = squared_gradients(ratio) / sums.gradient**2

    def eigenvalue(k):
        wave = np.sin(k @ x)
        return ((wave * slope1) @ x.T * ((wave * slope2) @ x.T)).sum(axis=1) / D

    axis = np.linspace(0, np.pi, 33)
    k = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    k = k[(k[:, 0] >= k[:, 1]) & (k[:, 1] >= k[:, 2])]  # the rest follows by symmetry
    best = k[np.argmax(eigenvalue(k))]
    step = np.pi / 32
    for _ in range(4):  # finer around the best
        near = best + step * (np.indices((9, 9, 9)).reshape(3, -1).T / 4 - 1)
        best, step = near[np.argmax(eigenvalue(near))], step / 4
    small = 1e-4
    return Stiffness(float(eigenvalue(np.array([[small, 0, 0]]))[0] / small**2), float(eigenvalue(best[None])[0]))


def relaxation(scene):
    """Return omega' = omega/(1 + eps_rel)."""
    pbf = scene.solver.pbf
    return pbf.omega / (1 + pbf.eps_rel)


def bottom_compression(scene, layers, dt):
    """Return the density error at the bottom of a resting column, C = 0.86 N_y g dt^2/(J d omega' c2)."""
    g = math.hypot(*scene.domain.gravity)
    gamma = layers * g * dt**2 / (scene.solver.pbf.iterations * scene.spacing)
    return 0.86 * gamma / (relaxation(scene) * stiffness(scene.solver.support).slow)


def longest_step(scene, layers):
    """Return the step [s] at which a column of ``layers`` spacings compresses by the scene's tolerance at its bottom."""
    per_second = bottom_compression(scene, layers, 1.0)
    return math.sqrt(scene.solver.pbf.compression / per_second) if per_second > 0 else math.inf


def softening(scene):
    """Return (eps, D0) [1/(kg m^2)] of a particle inside the lattice, both of the liquid's mass."""
    ratio, d = scene.solver.support, scene.spacing
    mass = scene.fluid.density * d**3
    D0 = squared_gradients(ratio) / (lattice_sums(ratio).gradient ** 2 * d**2 * mass)
    return scene.solver.pbf.eps_rel * D0, D0


def adaptive(scene):
    """Return whether particles have an effect precision."""
    return scene.solver.pressure == "pbf" and scene.solver.pbf.precision


def short_lists(scene):
    """Return whether effect precision shortens support radii: with the whole support as minimum it has iterations only."""
    return adaptive(scene) and scene.solver.pbf.minimum_support < scene.solver.support


def pbf_of(scene, real):
    """Return the `Pbf` tuple of a scene."""
    q, d, ratio = scene.solver.pbf, scene.spacing, scene.solver.support
    R, sums = scene.support, lattice_sums(ratio)
    eps, D0 = softening(scene)
    return P.make(
        P.Pbf,
        real,
        spacing=d,
        support=R,
        uniform=int(not short_lists(scene)),
        same_iterations=int(not adaptive(scene) or q.minimum_iterations >= q.iterations),
        value_scale=315 / (64 * math.pi * R**3 * sums.value),
        gradient_scale=45 / (math.pi * R**4 * sums.gradient),
        table_start=SHORTEST,
        table_step=(POINTS - 1) / (ratio - SHORTEST),
        table_last=POINTS - 1,
        omega=q.omega,
        softening=eps,
        minimum_error=0.0 if q.one_sided else -1.0,
        push=q.push / D0,
        push_scale=1 / (1 - q.push_distance**2),
        blend=q.xsph,
        vorticity=q.vorticity,
        iterations=q.iterations,
        minimum_iterations=min(q.minimum_iterations, q.iterations),
        minimum_support=min(q.minimum_support, ratio) * d,
        height_share=q.height_share,
        minimum_precision=q.minimum_precision,
        precision_time=q.precision_time,
        floor=scene.domain.lower[2],
        inverse_bin=4 / d,
    )


def vessel_of(scene, real):
    """Return the `Vessel` tuple: a quarter of a spacing inside the walled sides, very far at the open ones."""
    domain, d = scene.domain, scene.spacing
    lower = np.array(domain.lower, float)
    upper = lower + np.array(domain.cells) * d
    far = 1e30
    sides = {}
    for k, axis in enumerate("xyz"):
        sides[f"lower_{axis}"] = lower[k] + 0.25 * d if f"{axis}-" in domain.walls.sides else -far
        sides[f"upper_{axis}"] = upper[k] - 0.25 * d if f"{axis}+" in domain.walls.sides else far
    return P.make(P.Vessel, real, **sides)


def pbf_fields(scene, phase):
    """Return the initial arrays of the solve: the kernel table, full precision for every liquid particle."""
    liquid = phase == 0
    return {
        "kernel_scale": kernel_table(scene.solver.support),
        "effect_precision": np.where(liquid, 1.0, 0.0),
        "support_radius": np.where(liquid, scene.support, 0.0),
        "iterations": np.where(liquid, scene.solver.pbf.iterations, 0),
    }


def surface_height(bins, scene_spacing):
    """Return the height [m] above the floor of what counts as surface, from the histogram of quarters of a spacing.

    A spacing below the 95th percentile, at least a quarter of one.
    """
    total = np.cumsum(np.asarray(bins, dtype=np.int64))
    if total[-1] == 0:
        return 0.25 * scene_spacing
    k = int(np.searchsorted(total, 0.95 * total[-1]))
    return max(0.25 * (k + 1) - 1.0, 0.25) * scene_spacing
