"""One small scene of each system in which every dimensioned number is given, so that it can be told in other units."""

from base_scenes import D

_BOX = {
    "time": {"end": 0.01, "dt": 0.002, "n_sub_max": 64},
    "domain": {"lower": [0.0, 0.0, 0.0], "upper": [0.3, 0.4, 0.4], "spacing": D, "gravity": [0.0, 0.0, -9.81], "walls": {"layers": 1}},
    "fluid": {
        "fill": [{"lower": [0.0, 0.0, 0.0], "upper": [0.2, 0.4, 0.2], "velocity": [0.3, 0.1, 0.2]}], "temperature": 40.0,
        "density": 1000.0,
    },
}
_MATTER = {"latent_heat": 3e5, "conductivity": 2.0, "specific_heat": 2000.0}
_FLAT = {**_BOX["domain"], "lower": [0.0, 0.0, 0.0], "dimensions": 2}
SCENES = {
    "melting": {
        **_BOX,
        "heat": {"law": "physical", "latent": True, "conductivity": 50.0, "specific_heat": 4000.0},
        "fluid": {**_BOX["fluid"], "viscosity": "laminar", "mu": 3.0, "drag": 0.5},
        "solid": [{"position": [0.15, 0.2, 0.2], "size": [0.1, 0.2, 0.2], "anchor": "base", "density": 900.0, **_MATTER}],
        "solver": {"precision": "double"},
    },
    "position based": {**_BOX, "solver": {"pressure": "pbf", "precision": "double", "pbf": {"xsph": 12.0, "vorticity": 0.1}}},
    "boiling": {
        **_BOX, "fluid": {**_BOX["fluid"], "temperature": 99.9},
        "solver": {"pressure": "pbf", "precision": "double", "pbf": {"xsph": 12.0}},
        "boiling": {
            "diffusivity": 6e-3, "specific_heat": 4186.0, "latent_heat": 2e6, "latent_scale": 0.0, "nucleation_time": 0.002,
            "boost_rate": 0.5, "boost_speed": 0.5, "heater": {"transfer": 4.0, "half_size": [0.15, 0.2], "centre": [0.15, 0.2]},
            "bubbles": {"gas_density": 0.6, "merge_age": 0.002, "push_time": 0.016, "drift": 0.0},
        },
    },
    "slime": {
        **_BOX, "domain": _FLAT, "solver": {"pressure": "hybrid", "precision": "double", "ghosts": {}},
        "fluid": {**_BOX["fluid"], "sigma": 0.5,
                  "fill": [{"lower": [0.0, 0.0, 0.0], "upper": [0.2, 0.4, 0.2], "velocity": [0.3, 0.0, 0.2]}]},
        "viscosity": {"mu": 5.0},
    },
    "flood": {
        "time": {"end": 0.2, "dt": 0.05, "n_sub_max": 64},
        "terrain": {"shape": "flat", "lower": [0.0, 0.0], "upper": [4.0, 2.0], "cell": 0.5},
        "fluid": {"spacing": 0.4, "reference_depth": 0.5, "density": 1000.0,
                  "fill": [{"lower": [0.0, 0.0], "upper": [2.0, 1.5], "depth": 0.5, "velocity": [0.3, 0.1]}]},
        "gravity": 9.81, "friction": {"law": "darcy", "darcy": 0.1}, "control": {},
        "solver": {"precision": "double", "top_speed": 50.0},
        "output": {"raster": "none", "maps": False},
    },
}  # fmt: skip
