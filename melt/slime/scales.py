"""Natural scales of fields of incompressible liquids, for comparing backends on a live run."""

import math


def amended(scene, scales):
    """Return ``scales``, those of any liquid, made those of an incompressible scene: two dimensions, viscous pressure."""
    d, dim, dt = scene.spacing, scene.domain.dimensions, scene.time.dt
    rho, volume = scene.fluid.density, scene.particle_volume
    mu = 0.0 if scene.viscosity is None else scene.viscosity.mu
    speed = scales["speed"]
    pressure = max(scales["pressure"], mu * speed / d)
    mass = rho * volume
    return scales | {
        "force": pressure * d ** (dim - 1),
        "mass": mass,
        "volume": volume,
        "pressure": pressure,
        "number_density": 1 / volume,
        "acceleration": pressure / (rho * d),
        "mobility": 1 / mass,
        "momentum": mass * speed,
        "inverse_spacing": 1 / d,
        "inverse_area": 1 / d**2,
        "dfsph_factor": rho * d**2,
        "impulse": pressure * dt**2,
        "poisson": pressure * volume / d**2,
        # a residual is what larger terms leave, and the sums are of its squares
        "poisson_sums": (0.2 * pressure * volume / d**2) ** 2,
        "viscosity": mu or 1.0,
        "pair_shear": math.sqrt(mu * volume) / d or 1.0,
        "viscous_block": dt / mass,
    }
