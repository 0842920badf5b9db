"""Parameters of the check inputs, and the variants in which each stage is checked."""

from melt import params as P
from melt.check import _boiling, _cloud, _pbf, _screen, _slime, _slime_apic, _slime_ghosts, _slime_motion, _slime_solve
from melt.check import _flood_values as _flood

#: Parameter tuples with values that exercise every term.
TUPLES = {
    "smoothing": (P.Smoothing, dict(support=_cloud.SUPPORT, kernel=P.CUBIC, laplacian=P.L_VISC, dimension=3)),
    "grid": (P.Grid, {}),  # from the cloud
    "fluid": (
        P.Fluid,
        dict(
            sound_speed=20.0,
            viscosity=P.ARTIFICIAL,
            alpha=0.2,
            mu=0.5,
            solid_friction=0.15,
            wall_friction=0.05,
            mirror=1.0,
            clamp=1,
            density_factor=1.0015,
            minimum_volume=_cloud.SPACING**3,
            number_density=1,
            central=0.7,
            gravity_x=0.3,
            gravity_y=-0.2,
            gravity_z=-9.81,
            expansion=2e-4,
            reference_temperature=20.0,
            drag=0.5,
            xsph=0.1,
            surface_tension=0.7,
        ),
    ),
    "lattice": (
        P.Lattice,
        dict(
            width=2,
            spacing=_cloud.SPACING,
            solid_volume=P.VOLUME_REST,
            solid_scale=0.77,
            rotation=P.ROTATION_SVD,
            iterations=60,
            tolerance=1e-7,
            stiffness=0.9,
            damping=0.05,
            refill=P.REFILL_AFFECTED,
            connect=26,
        ),
    ),
    "contact": (P.Contact, dict(distance=_cloud.SPACING, stiffness=0.25, damping=0.1, friction=0.2, connect=26)),
    "guard": (P.Guard, dict(distance=0.5 * _cloud.SPACING)),
    "heat": (
        P.Heat,
        dict(
            law=P.HEAT_PHYSICAL,
            current_volume=0,
            full_sweep=0,
            latent=1,
            ambient_temperature=15.0,
            ambient_transfer=5e7,
            full_neighbours=80.0,
            ambient_area=2.5,
            spacing=_cloud.SPACING,
            wall_fixed=0,
        ),
    ),
    "change": (P.Change, dict(own_liquid=1, latent=1, hysteresis=0.5, reach=0.6 * _cloud.SPACING)),
    "reconstruction": (
        P.Reconstruction,
        dict(reach=2 * _cloud.SPACING, radius=0.6 * _cloud.SPACING, correct=1, temperature=1),
    ),
    "pbf": (P.Pbf, _pbf.constants()),
    "vessel": (
        P.Vessel,
        dict(lower_x=0.05, lower_y=-1e30, lower_z=0.02, upper_x=1.25, upper_y=1e30, upper_z=1e30),
    ),
    "boiling": (P.Boiling, _boiling.BOILING),
    "bubbles": (P.Bubbles, _boiling.BUBBLES),
    "vapour": (P.Vapour, _boiling.VAPOUR_VALUES),
    "condensate": (P.Condensate, _boiling.CONDENSATE),
    "tank": (P.Tank, _boiling.TANK),
    "sph": (P.Sph, _boiling.SPH),
    "flood": (P.Flood, _flood.FLOOD),
    "terrain_grid": (P.Terrain, _flood.TERRAIN),
    "control": (P.Control, _flood.CONTROL),
    "basin": (P.Basin, _flood.BASIN),
    "friction": (P.Friction, _flood.FRICTION),
    "sampling": (P.Sampling, _flood.SAMPLING),
    "period": (P.Period, _slime.PERIOD),
    "dfsph": (P.Dfsph, _slime.DFSPH),
    "poisson": (P.Poisson, _slime.POISSON),
    "viscous": (P.Viscous, _slime.VISCOUS),
    "ghosts": (P.Ghosts, _slime.GHOSTS),
    "apic": (P.Apic, _slime.APIC),
    "elastic": (P.Elastic, _slime.ELASTIC),
    "view": (P.View, _screen.VIEW),
    "splat": (P.Splat, _screen.SPLAT),
    "filter": (P.Filter, _screen.FILTER),
    "optics": (P.Optics, _screen.OPTICS),
    "relief": (P.Relief, _screen.RELIEF),
    "domain": (
        P.Domain,
        dict(lower_x=-1.0, lower_y=-1.0, lower_z=-1.0, upper_x=1.5, upper_y=6.0, upper_z=20.0, delete=1),
    ),
}

#: Scalars: value; an int stays int32, a float gets the run's precision.
SCALARS = {
    "dt": 1e-3,
    "mirror": 1.0,
    "smallest": 3,
    "factor": 0.3,
    "full_neighbours": 80.0,
    "first": 2,
    "count": 5,
    "slot": 7,
    "lag": 2e-3,
    "reverse": 0,
    "iteration": 2,
    "height": 0.6,
    "key": 3,
    "target": 115.0,
    "share": 0.3,
    "mean_u": 0.3,
    "mean_v": -0.2,
    "mean_w": 0.1,
    "mean_temperature": 60.0,
    "step_low": 77,
    "step_high": 0,
    "first_id": 5000,
    "served": 1,
    "coarse": 2,
    "along": 0,
    "longest": 0.9,
    "deviation": 1.7,
    "shift": 0.01,
    "momentum": 0.4,
    "sigma": 40.0,
}

#: Entries of parameter tuples that switch code paths, and the values to try one at a time.
SWITCHES = {
    "smoothing": {"kernel": (0, 1, 2), "laplacian": (0, 1, 2)},
    "fluid": {"viscosity": (0, 1), "clamp": (0, 1), "number_density": (0, 1), "mirror": (0.0, 1.0)},
    "lattice": {
        "solid_volume": (0, 1, 2),
        "rotation": (0, 1, 2),
        "refill": (0, 1, 2),
        "connect": (6, 18, 26),
        "width": (0, 1, 2),
    },
    "heat": {
        "law": (0, 1),
        "current_volume": (0, 1),
        "full_sweep": (0, 1),
        "latent": (0, 1),
        "wall_fixed": (0, 1),
    },
    "contact": {"connect": (6, 18, 26)},
    "pbf": {"uniform": (0, 1), "same_iterations": (0, 1), "minimum_error": (-1.0, 0.0)},
    "boiling": {"corrected": (0, 1), "mass_model": (0, 1, 2), "boost": (0, 1, 2, 3, 4)},
    "bubbles": {"literal_radius": (0, 1), "plain_mean": (0, 1), "upward": (0, 1), "normalised": (0, 1), "push_even": (0, 1)},
    "vapour": {"adapt": (0, 1)},
    "change": {"own_liquid": (0, 1), "latent": (0, 1)},
    "domain": {"delete": (0, 1)},
    "reconstruction": {"correct": (0, 1), "temperature": (0, 1)},
    **_flood.SWITCHES,
    "optics": {"mapped": (0, 1)},
    "poisson": {"clamp": (0, 1)},
    "viscous": {"law": (0, 1, 2), "gamma": (0.0, 10.0)},
    "apic": {"affine": (0, 1), "literal": (0, 1), "flip": (0.0, 0.1)},
}

#: Extra variants of single stages.
EXTRA = {
    "reorder_scalar": [{"kind": "int"}],
    "neighbours_grid": [{"capacity": 20}],
    "neighbours_kdtree": [{"capacity": 20}],
    "heat_onesided": [{"reverse": 1}],
    "crumble": [{"smallest": 0}, {"smallest": 8}],
    "list_slots": [{"key": 5}, {"key": 0}],
    "order_by_id": [{"n": 1200}],  # more than one run
    "spawn_bubbles": [{"n": 1200, "served": 7}],
    "boiled_sums": [{"n": 1200, "served": 7}],
    "vapour_source": [{"n": 1200, "served": 9}],
    "condense": [{"n": 1200, "served": 9}],
    **{name: [{"bubbles": True}] for name in ("pbf_begin", "pbf_list", "pbf_lambda", "pbf_correction", "pbf_xsph", "iteration_key")},
    "screen_project": [{"below": 1}],
    **{name: [{"along": 1}] for name in ("bilateral_pass", "narrow_pass", "screen_blur")},
    "freeze_choice": [{"dt": 0.25 * _cloud.SPACING}],  # below 2 m/s: some are too fast
    **_flood.EXTRA,
    **_slime_solve.EXTRA,
    **_slime_ghosts.EXTRA,
    **_slime_apic.EXTRA,
    **_slime_motion.EXTRA,
}

#: Particles that the variants of a stage need at least: one that boils needs four free slots.
LEAST = {"spawn_bubbles": 301, "boiled_sums": 301}

#: What stages need besides when there is no particle, or one.
SMALL = {
    **{name: {"served": 0} for name in ("spawn_bubbles", "boiled_sums", "vapour_source", "condense")},
    **{name: {"count": 0, "slot": 0} for name in ("emit_motion", "emit_matter", "enter", "emit_apic")},
}
