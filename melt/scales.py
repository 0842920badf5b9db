"""Natural scales of fields, for comparing backends on a live run."""

import numpy as np

from melt.flood import scales as flood
from melt.slime import scales as slime


def scales_of(scene, initial, settings):
    """Return the natural scale of each kind of field, for comparing backends on a live run."""
    if scene.kind == "flood":
        return flood.natural(scene, initial)
    dx, rho, cs = scene.spacing, scene.fluid.density, settings.sound_speed
    mass = rho * dx**3
    T = initial["temperature"] if "temperature" in initial else np.array([0.0, 1.0])
    k = float(initial["material_conductivity"].max(initial=0.0)) if "material_conductivity" in initial else 1.0
    c = 1.0 if scene.heat is None or scene.heat.law == "paper" else rho * float(initial["material_specific_heat"].max())
    latent = (
        mass * float(initial["material_latent_heat"].max(initial=0.0)) if "material_latent_heat" in initial else 1.0
    )
    # 1 % of rho c_s^2 is the pressure that the sound speed was chosen for
    pressure = 0.01 * rho * cs**2
    found = {
        "one": 1.0,
        "spacing": dx,
        "speed": 0.1 * cs,
        "force": pressure * dx**2,
        "mass": mass,
        "volume": dx**3,
        "density": rho,
        "pressure": pressure,
        "temperature": max(1.0, float(np.ptp(T))),
        "conductivity": k or 1.0,
        "heat_capacity": c * dx**3,
        "heat": c * dx**3 * max(1.0, float(np.ptp(T))),
        "latent_energy": latent or 1.0,
        "specific_heat": c,
        "latent_heat": 1.0,
        "number_density": 1 / dx**3,
        "rate": 0.1 * cs / dx,
        "acceleration": cs**2 / dx * 0.01,
        "mobility": 1 / mass,
        "multiplier": 0.1 * mass * dx**2,
        "time": 1.0,
        "momentum": mass * 0.1 * cs,
        "bubble_push": mass * 0.1 * cs * dx**3,
        "rate2": (0.1 * cs / dx) ** 2,
    }
    return slime.amended(scene, found) if scene.incompressible else found


def fourier_number(scene, initial):
    """Return Fo = alpha dt / dx^2 of the fastest material (alpha = 2 K in paper mode)."""
    k = initial["material_conductivity"]
    if scene.heat.law == "paper":
        alpha = 2 * k
    else:
        alpha = k / (initial["material_density"] * initial["material_specific_heat"])
    return float(alpha.max(initial=0.0)) * scene.time.dt / scene.spacing**2


def explicit_heat_limit(scene, settings):
    """Return the longest step [s] of forward Euler in the material that conducts best, on the rest lattice."""
    return scene.support**2 / 14.2 / max(settings.fourier_number * scene.spacing**2 / scene.time.dt, 1e-300)
