"""Columns of water at the start: places, volumes, depths, velocities of the pools of a scene."""

import inspect

import numpy as np

from melt.errors import GeometryError, SceneError
from melt.flood.bed import bed_at
from melt.flood.lattice import sigma_of
from melt.flood.profiles import PROFILES
from melt.flood.walls import extent
from melt.geometry.calibration import calibrate
from melt.geometry.columns import place
from melt.geometry.pools import region_of, without

SWEEPS = 30  # that even out a layout


def columns(scene, terrain, outlines, distance, boundary, notes):
    """Return (x (2, n) local [m], volume (n,) [m^3], depth (n,) [m], velocity (2, n) [m/s]) of all pools.

    Raises:
        GeometryError: a pool lies outside of the terrain or is dry.
        SceneError: an unknown profile, or a parameter that it does not have.
    """
    found, earlier = [], []
    for k, pool in enumerate(scene.fluid.fill):
        found.append(_one(scene, terrain, outlines, pool, f"fluid.fill {k}", earlier, notes))
        earlier.append(region_of(pool))
    if not found:
        return np.zeros((2, 0)), np.zeros(0), np.zeros(0), np.zeros((2, 0))
    x, volume, depth, velocity = (np.concatenate(parts, axis=-1) for parts in zip(*found))
    if scene.fluid.calibrate:
        bed = bed_at(terrain, *x, scene.terrain.sampler)
        wall = None if not boundary.area.size else (*boundary, bed_at(terrain, *boundary.x, scene.terrain.sampler))
        volume, depth = _calibrated(scene, x, volume, depth, wall, bed, notes)
    return x, volume, depth, velocity


def flow_of(pool, terrain, gravity, sampler, name, time=None):
    """Return the function of local x, y that gives (depth, u, v) of a pool, at ``time`` [s] where its profile knows.

    Raises:
        SceneError: an unknown profile, or a parameter that it does not have.
    """
    parameters = dict(pool.parameters) | ({} if time is None else {"time": time})
    if pool.profile is not None:
        known = list(inspect.signature(PROFILES[pool.profile]).parameters)[4:]
        for key in parameters:
            if key not in known:
                raise SceneError(f"{name}: profile {pool.profile!r} has no parameter {key!r}; it has {', '.join(known)}")

    def flow(x, y):
        X, Y = terrain.world(np.stack([x, y]))
        b = bed_at(terrain, x, y, sampler)
        if pool.profile is not None:
            return PROFILES[pool.profile](X, Y, b + terrain.datum, gravity, **parameters)
        d = np.full_like(b, pool.depth) if pool.depth is not None else np.maximum(pool.stage - terrain.datum - b, 0.0)
        return d, np.full_like(b, pool.velocity[0]), np.full_like(b, pool.velocity[1])

    return flow


def _one(scene, terrain, outlines, pool, name, earlier, notes):
    """Return x, volume, depth, velocity of one pool."""
    fluid = scene.fluid
    low, high = terrain.bounds
    if pool.lower is not None:
        low = np.maximum(low, terrain.local(pool.lower))
        high = np.minimum(high, terrain.local(pool.upper))
    elif pool.centre is not None:
        middle = terrain.local(pool.centre)
        low, high = np.maximum(low, middle - pool.radius), np.minimum(high, middle + pool.radius)
    elif pool.polygon is not None:
        corners = terrain.local(np.array(pool.polygon).T)
        low, high = np.maximum(low, corners.min(axis=1)), np.minimum(high, corners.max(axis=1))
    if (high <= low).any():
        raise GeometryError(f"{name} lies outside of the terrain, {extent(terrain)}: move it, or widen the terrain")
    flow = flow_of(pool, terrain, scene.gravity, scene.terrain.sampler, name)
    mine, free = region_of(pool), without(outlines)

    def region(x, y):
        X, Y = terrain.world(np.stack([x, y]))
        taken = np.zeros(np.shape(X), bool)
        for other in earlier:
            taken |= other(X, Y)
        row, column = terrain.node(np.stack([x, y]))
        blocked = (terrain.blocked | terrain.open)[np.clip(row, 0, terrain.shape[0] - 1), np.clip(column, 0, terrain.shape[1] - 1)]
        return mine(X, Y) & free(x, y) & ~taken & ~blocked

    equal = fluid.layout == "equal_mass"
    try:
        x, volume = place(
            lambda x, y: flow(x, y)[0], low, high, fluid.spacing, layout=fluid.layout,
            reference_depth=fluid.reference_depth if equal else None, seed=fluid.seed, jitter=fluid.jitter,
            relax=SWEEPS if fluid.even else 0, region=region,
        )
    except GeometryError as error:
        if str(error).startswith("no water"):
            raise GeometryError(f"{name} is dry: its stage lies below the bed, or walls and obstacles fill its region") from None
        raise GeometryError(f"{name}: {error}") from None
    depth, u, v = flow(*x)
    notes.append(f"{name}: {x.shape[1]:,} columns, {volume.sum():.6g} m^3, {depth.max(initial=0.0):.4g} m deep at most")
    return x, volume, np.maximum(depth, 1e-6), np.stack([u, v])


def _calibrated(scene, x, volume, depth, wall, bed, notes):
    """Return volumes whose sums are the depths that the pools ask for, and those sums."""
    bias = 1 / sigma_of(scene) - 1
    before = volume.sum()
    volume, report = calibrate(x, volume, depth, scene.solver.support, wall, bed=bed, bias=bias)
    notes.append(f"masses adjusted by {volume.sum() / before - 1:+.2e} in all so that depths are those of the fills: {report}")
    return volume, depth
