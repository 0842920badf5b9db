"""Variants of the check scene for the solves of incompressible and viscous liquids."""

import numpy as np

#: Arrays of length 0 where the scene has none: no heat, Newtonian, no augmented Lagrangian, no ghosts.
OPTIONAL = ("temperature", "shear_rate", "dilation", "viscous_pressure", "ghost_laplacian")
BOX = dict(length_x=32.0, inverse_x=1 / 32)  # exact, and so long that nothing meets its own image
EXTRA = {
    "viscosity": [{"temperature": 0}, {"shear_rate": 0}, {"power": 1.0}, {"yield_stress": 0.0}, {"law": 2, "slope": 0.02}],
    "pair_shear": [{"gamma": 0.0}, {"dimension": 2}, BOX],
    "viscous_start": [{"dilation": 0, "viscous_pressure": 0}],
    "viscous_apply": [{"dilation": 0}],
    "poisson_pairs": [{"ghost_laplacian": 0}, {"dimension": 2}, BOX],
}


def adapted(arrays, choice):
    """Return the scene without the arrays that a variant does without, and every third particle one box away."""
    arrays = {**arrays, **{name: np.zeros(0) for name in OPTIONAL if choice.get(name) == 0}}
    if "length_x" in choice:
        x = arrays["position"].copy()
        x[0, ::3] += choice["length_x"]
        arrays["position"] = x
    return arrays
