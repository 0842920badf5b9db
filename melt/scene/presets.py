"""Presets: values of keys that a scene does not give. Melting spec, section 2."""

#: "default" is the model's own defaults. A preset adds no heat to a scene without it.
PRESETS = {
    "default": {},
    # As literal as the printed equations allow: no mirrored pressure, full-step pair sweeps with m/rho
    # volumes, one sub-step per step with the sound speed that this allows, KD-tree, single precision.
    # Contact of solids (absent in the paper) stays on: its Figures 5 and 6 need it.
    "paper": {
        "time": {"n_sub": 1},
        "fluid": {"sound_speed": "legal", "wall_friction": 0.0},
        "heat": {
            "law": "paper", "solver": "pairs_coloured", "sweep_dt": "full", "volume": "current",
            "latent": False, "refreeze": False,
        },
        "solver": {
            "mirror": 0.0, "solid_scale": 1.0, "solid_volume": "rest", "damping": 0.0, "guard": False,
            "neighbours": "kdtree", "precision": "single", "refill": "all", "melt_to": "water",
            "density_form": "number", "calibrate_mass": False,
        },
    },
    # Latent heat, real heat capacities, melting that keeps the mass.
    "physical": {
        "heat": {"law": "physical", "latent": True},
        "solver": {"melt_to": "own", "density_form": "volume"},
    },
}
WATER_DIFFUSIVITY = 1.6e-7  # of heat, m^2/s
#: What the presets mean for a scene that boils (boiling spec 4).
BOILING_PRESETS = {
    # every choice of the paper that can be told: boiling free of charge, at once, mean position, upward velocity
    "paper": {
        "boiling": {
            "latent_scale": 0.0, "nucleation_time": 0.0, "boost": "literal", "boost_rate": 0.02,
            "heater": {"mode": "dirichlet", "temperature": 100.0},
            "bubbles": {"merge_position": "mean", "merge_velocity": "up"},
        },
        "solver": {"precision": "single"},
    },
    # the whole latent heat, and heat that conducts as in water
    "physical": {"boiling": {"latent_scale": 1.0, "diffusivity": WATER_DIFFUSIVITY, "boost": "boussinesq"}},
}
#: The same where [heat] says how liquid and solids conduct.
KETTLE_PRESETS = BOILING_PRESETS | {
    "physical": {"boiling": {"latent_scale": 1.0, "boost": "boussinesq"}, "heat": {"latent": True, "conductivity_scale": 1.0},
                 "solver": {"melt_to": "own"}},
}
#: What the presets mean for a flood (flood spec 2-4, 8).
FLOOD_PRESETS = {
    "default": {},
    # the paper's Table 1 and what it says of its method: linear gas law, support of the step before, no Lax-Friedrichs,
    # Euler steps of a fixed length, bilinear terrain, control with corners a support away, walls of the reference depth
    "paper": {
        "time": {"n_sub": 1},
        "terrain": {"sampler": "bilinear"},
        "fluid": {"calibrate": False},
        "boundary": {"law": "paper"},
        "control": {"mode": "paper", "slope_on": 0.0, "slope_full": 0.0, "clamp": False, "spread": 1.0},
        "solver": {
            "form": "linear", "kernel": "cubic", "iterations": 0, "alpha": 0.0, "viscosity": 1e-4, "first_kick": "full",
            "precision": "single",
        },
    },
    # what the shallow water equations say, as closely as this method can
    "physical": {"solver": {"form": "variational", "precision": "double", "cfl": 0.2}},
}
#: What the presets mean for an incompressible liquid (slime spec 2).
SLIME_PRESETS = {
    # as published: Jacobi iterations without momentum, half of the pressure kept, viscosity and pressure one after the
    # other, no pull on a liquid that has come apart
    "paper": {
        "viscosity": {"stokes": "split"},
        "solver": {"precision": "single", "dfsph": {"accelerate": False, "warm_start": 0.5, "pull": 0.0}},
    },
    # latent heat, real heat capacities and melting that keeps the mass where it has heat
    "physical": {
        "heat": {"law": "physical", "latent": True}, "viscosity": {"stokes": "al"}, "solver": {"melt_to": "own", "density_form": "volume"},
    },
}
OPTIONAL_SECTIONS = {"heat", "boiling", "heater", "control", "viscosity"}
