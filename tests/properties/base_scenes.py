"""One small legal scene of each system, as dictionaries: what faults are put into."""

D = 0.1
_BOX = {
    "time": {"end": 0.01, "dt": 0.002, "n_sub_max": 64},
    "domain": {"upper": [0.3, 0.3, 0.4], "spacing": D, "walls": {"layers": 1}},
    "fluid": {"fill": [{"lower": [0.0, 0.0, 0.0], "upper": [0.3, 0.3, 0.2]}], "temperature": 40.0},
}
SCENES = {
    "melting": {
        **_BOX, "heat": {}, "solid": [{"position": [0.15, 0.15, 0.2], "size": [0.1, 0.1, 0.2], "anchor": "base"}],
        "solver": {"precision": "double"},
    },
    "boiling": {
        **_BOX, "fluid": {**_BOX["fluid"], "temperature": 99.9}, "solver": {"pressure": "pbf", "precision": "double"},
        "boiling": {"heater": {}, "latent_scale": 0.0, "nucleation_time": 0.01},
    },
    "slime": {
        **_BOX, "domain": {**_BOX["domain"], "dimensions": 2}, "solver": {"pressure": "hybrid", "precision": "double", "ghosts": {}},
        "viscosity": {"mu": 5.0},
    },
    "flood": {
        "time": {"end": 0.2, "dt": 0.05, "n_sub_max": 64},
        "terrain": {"shape": "flat", "lower": [0.0, 0.0], "upper": [4.0, 2.0], "cell": 0.5},
        "fluid": {"spacing": 0.4, "reference_depth": 0.5, "fill": [{"lower": [0.0, 0.0], "upper": [2.0, 2.0], "depth": 0.5}]},
        "solver": {"precision": "double"},
        "output": {"raster": "none"},
    },
}
