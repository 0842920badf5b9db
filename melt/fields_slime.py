"""Arrays of incompressible and viscous liquids: rows of the table of `melt.fields`. Slime spec 1.1.

Liquid particles are the nodes of the method. Symmetric tensors are stored as xx, yy, zz, xy, xz, yz,
general ones row by row.
"""

EXTENTS = {
    "apic": "APIC particles, inactive slots included",
    "ghost": "capacity for air ghost particles",
    "ghost_point": "lattice points of ghost candidates: cells of the neighbour grid times points of a cell, x fastest in both",
    "driver": "moving bodies",
    "offset": "APIC particles that enter with a node",
    "nozzle": "nozzles that hold the liquid in them",
}

TABLE = [
    # nodes: pairs
    ("density_ratio", "particle", "real", "1", "one", "density over rest density, sum of V_j W over liquid and boundary, itself included"),
    ("completed_ratio", "particle", "real", "1", "one", "density ratio completed by air ghost particles, not above 1 by them"),
    ("pair_gradient", "3 particle neighbour", "real", "1/m", "inverse_spacing", "V_j grad W_ij of each neighbour of the list"),
    ("dfsph_factor", "particle", "real", "kg/m", "dfsph_factor",
     "pressure times dt^2 per density error (alpha of DFSPH); 0: it has no pressure"),
    ("held", "particle", "int", "1", "", "1 for liquid inside a nozzle, whose velocity is given"),
    # nodes: pressure
    ("compression_source", "particle", "real", "1", "one", "density error that the solve has to remove"),
    ("solver_pressure", "particle", "real", "Pa", "pressure", "pressure of the solve under way"),
    ("pressure_last", "particle", "real", "Pa", "pressure", "what the last update gave, before it was extrapolated"),
    ("pressure_acceleration", "3 particle", "real", "m/s^2", "acceleration", "acceleration by solver_pressure"),
    ("density_impulse", "particle", "real", "Pa s^2", "impulse", "pressure of the last density solve times dt^2"),
    ("divergence_impulse", "particle", "real", "Pa s^2", "impulse", "pressure of the last divergence solve times dt^2"),
    ("compression_left", "particle", "real", "1", "one", "density error that an iteration found, 0 where negative or without pressure"),
    ("pressure_error", "3 reduction", "double", "1", "one", "sum and maximum of the density error left, and particles counted"),
    ("source_sums", "2 reduction", "double", "1", "one", "sum of compression_source, and particles counted"),
    ("surface_normal", "3 particle", "real", "1", "one", "normal of the free surface into the liquid, 0 away from it"),
    ("surface_pressure", "particle", "real", "Pa", "pressure", "pressure of surface tension, sigma times curvature"),
    ("pair_poisson", "particle neighbour", "real", "m", "spacing", "matrix entries s_ij of the pressure Poisson equation"),
    ("poisson_ghost", "particle", "real", "m", "spacing", "share of air ghost particles in its diagonal"),
    ("poisson_diagonal", "particle", "real", "m", "spacing", "its diagonal; 0: the particle has no pressure"),
    ("poisson_pressure", "particle", "real", "Pa", "pressure", "pressure of the Poisson equation"),
    ("poisson_residual", "particle", "real", "N/m", "poisson", "residual"),
    ("poisson_direction", "particle", "real", "Pa", "pressure", "search direction"),
    ("poisson_product", "particle", "real", "N/m", "poisson", "matrix times the search direction"),
    ("poisson_sums", "5 reduction", "double", "1", "poisson_sums", "partial sums of r.z, p.Ap, the next r.z, r.r and b.b"),
    # nodes: viscosity
    ("viscosity", "particle", "real", "Pa s", "viscosity", "dynamic viscosity mu"),
    ("shear_rate", "particle", "real", "1/s", "rate", "sqrt(2 D:D) of the velocity gradient"),
    ("pair_shear", "3 particle neighbour", "real", "(kg/s)^(1/2)", "pair_shear", "w = sqrt(k_ij) x_ij, a pair's force is -w (w . v_ij)"),
    ("viscous_block", "6 particle", "real", "s/kg", "viscous_block", "inverse of the particle's diagonal block; 0: its velocity is given"),
    ("velocity_free", "3 particle", "real", "m/s", "speed", "velocity before viscosity acts"),
    ("dilation", "particle", "real", "Pa", "pressure", "gamma mu div v of the augmented Lagrangian"),
    ("viscous_pressure", "particle", "real", "Pa", "pressure", "its multiplier, the pressure inside a viscous thread"),
    ("viscous_residual", "3 particle", "real", "kg m/s^2", "force", "residual"),
    ("viscous_direction", "3 particle", "real", "m/s", "speed", "search direction"),
    ("viscous_product", "3 particle", "real", "kg m/s^2", "force", "matrix times the search direction"),
    ("viscous_sums", "5 reduction", "double", "1", "one", "partial sums of r.z, p.Ap, the next r.z, r.r and b.b"),
    # nodes: motion
    ("position_kept", "3 particle", "position", "m", "spacing", "position at the start of the sub-step"),
    ("velocity_kept", "3 particle", "real", "m/s", "speed", "velocity at the start of the sub-step"),
    ("velocity_transport", "3 particle", "real", "m/s", "speed", "velocity that moves the particles: their own, and the shift"),
    ("background_pressure", "particle", "real", "Pa", "pressure", "a constant, whose gradient is that of disorder alone"),
    ("velocity_correction", "3 particle", "real", "m/s", "speed", "velocity minus that which led to where forces are solved"),
    ("node_state", "particle", "int", "1", "", "1 for a node without mass, which takes part in nothing"),
    ("driver", "particle", "int", "1", "", "moving body of a driven particle, -1 for none"),
    ("driver_motion", "10 driver", "real", "m/s, 1/s, m, s", "speed", "velocity, spin, centre of a moving body, and k of its turn"),
    ("body_load", "3 driver reduction", "double", "N", "force", "partial sums of the liquid's force on a moving body"),
    ("nozzle_place", "8 nozzle", "real", "m", "spacing",
     "centre of the outlet (3), direction (3), length and radius within which liquid is held"),
    ("nozzle_speed", "nozzle", "real", "m/s", "speed", "speed of the liquid in it"),
    ("slime_bounds", "3 reduction", "real", "m/s, 1/s, m", "speed",
     "largest speed of liquid, largest affine velocity, farthest miss of an arrival"),
    # APIC particles
    ("apic_id", "apic", "int", "1", "", "permanent number of the APIC particle"),
    ("apic_phase", "apic", "int", "1", "", "0 active, 5 inactive"),
    ("apic_position", "3 apic", "position", "m", "spacing", "position"),
    ("apic_velocity", "3 apic", "real", "m/s", "speed", "velocity at its weighted centroid"),
    ("apic_affine", "9 apic", "real", "1/s", "rate", "affine velocity C_ab = dv_a/dx_b"),
    ("apic_mass", "apic", "real", "kg", "mass", "mass"),
    ("apic_strain", "6 apic", "real", "1", "one", "conformation tensor b of the elastic stress"),
    ("apic_state", "apic", "int", "1", "", "1 for an orphan, without a node near"),
    ("apic_cell", "apic", "int", "1", "", "cell of the APIC particle"),
    ("apic_order", "apic", "int", "1", "", "APIC particle that comes k-th in cell order"),
    ("apic_arrival", "apic", "int", "1", "", "scratch of the sort by cell"),
    ("apic_start", "cell", "int", "1", "", "first sorted APIC particle of a cell"),
    ("apic_weight", "apic", "real", "1/m^3", "number_density", "S_p, sum of the kernel over nodes; 0 for an orphan"),
    ("apic_centre", "3 apic", "real", "m", "spacing", "weighted centroid of its nodes minus its position"),
    ("apic_inverse", "6 apic", "real", "1/m^2", "inverse_area", "pseudo-inverse of the second moment D of its nodes"),
    ("apic_offset", "3 offset", "real", "m", "spacing", "place of an APIC particle relative to the node that it enters with"),
    ("apic_sums", "3 reduction", "double", "1, kg, 1", "one", "orphans, their mass, and active APIC particles"),
    # air ghost particles
    ("ghost_state", "ghost_point", "int", "1", "", "0 none, 1 candidate, 2 ghost, 3 dropped by thinning"),
    ("ghost_start", "cell", "int", "1", "", "first ghost of a cell; the last but one entry is their number"),
    ("ghost_position", "3 ghost", "position", "m", "spacing", "position"),
    ("ghost_volume", "ghost", "real", "m^3", "volume", "false volume"),
    ("ghost_laplacian", "particle", "real", "1/m^2", "inverse_area", "sum of V_g F r^2/(r^2 + eps^2) over ghosts"),
]

#: Fields that travel when nodes are sorted, and when APIC particles are.
CARRIED = ("density_impulse", "divergence_impulse", "poisson_pressure", "viscous_pressure", "position_kept", "velocity_kept", "driver")
APIC_CARRIED = ("apic_id", "apic_phase", "apic_position", "apic_velocity", "apic_affine", "apic_mass", "apic_strain")
