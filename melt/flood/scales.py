"""Natural scales of the fields of a flood, for comparing backends on a live run."""

import math


def natural(scene, initial):
    """Return the natural scale of each kind of field: a flood has depths and fluxes, and no pressure or heat."""
    dx = scene.spacing
    depth = max(float(initial["depth"].max(initial=0.0)), scene.fluid.reference_depth)
    speed = math.sqrt(scene.gravity * depth)
    volume = scene.column_volume
    return {
        "one": 1.0, "spacing": dx, "depth": depth, "speed": speed, "mass": volume * scene.fluid.density, "volume": volume,
        "acceleration": scene.gravity * depth / dx, "rate": speed / dx, "area": dx**2, "curvature": depth / dx**2,
        "flux": depth * speed, "time": 1.0,
    }
