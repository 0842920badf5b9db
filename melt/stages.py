"""The registry: one entry per stage, in pipeline order.

Plan, binders, cross-check, ``docs/stages.md`` and the law tests derive from it; there is
no second list (`melt.stages_boiling`, `melt.stages_flood`, `melt.stages_slime` and `melt.stages_screen` are parts of it). A stage's arguments are, in this order: fields it only reads, parameters
(NamedTuples of `melt.params` in lower case, then scalars such as ``dt``), fields it writes.
A field that is read and written stands among the written ones.
"""

from melt.registry import COPY, EIGEN, EXACT, FEW, NEAR, REGION, STIFF, SUM, SWEEP, stage
from melt.stages_boiling import LIST as BOILING
from melt.stages_flood import LIST as FLOOD
from melt.stages_screen import LIST as SCREEN
from melt.stages_slime import LIST as SLIME

_LATENT = "heat_capacity_molten latent_point latent_capacity"
_THERMAL = f"conductivity heat_volume heat_capacity {_LATENT}"
_ENTHALPY = f"heat_capacity {_LATENT} heat_conductance"
_LIST = [
    # ---- inflow: new particles into the inactive slots that follow the sorted active ones
    stage("emit_motion", "inflow", "melting 1 stage 0", "inflow_position inflow_velocity phase position velocity latent_energy",
           "first count slot lag", "phase position velocity latent_energy", FEW, partial=True),
    stage("emit_matter", "inflow", "melting 1 stage 0", "inflow_mass inflow_volume inflow_temperature inflow_material"
           " mass rest_volume temperature material site", "first count slot", "mass rest_volume temperature material site", COPY, partial=True),
    # ---- neighbours: line 1-2
    stage("cell_index", "grid", "melting 2.9", "position phase", "grid", "cell", EXACT),
    stage("cell_sort", "grid", "melting 2.9", "cell", "", "order cell_start arrival chunk_sum", EXACT, scratch="arrival chunk_sum"),
    stage("reorder_scalar", "grid", "melting 2.9", "order source", "", "target", COPY),
    stage("reorder_vector", "grid", "melting 2.9", "order source", "", "target", COPY),
    stage("site_particle", "grid", "melting 2.9", "phase site", "", "site_particle", EXACT),
    stage("neighbours_grid", "neighbours", "melting 2.9", "position phase cell_start", "grid smoothing", NEAR, EXACT),
    stage("kdtree_build", "kdtree", "melting 2.9", "position", "", "tree tree_rank", EXACT, scratch="tree_rank"),
    stage("neighbours_kdtree", "kdtree", "melting 2.9", "position phase tree", "smoothing", NEAR, EXACT),
    # ---- SPH volumes, density, pressure: line 4
    stage("liquid_volume", "volume", "melting 2.2", "phase rest_volume", "fluid", "volume", COPY),
    stage("rest_sum", "volume", "melting 2.2", "site_rest site_region site_region_count", "smoothing", "rest_sum", SUM),
    stage("solid_volume_rest", "volume", "melting 2.2",
           "position rest_volume site_particle site_region site_region_count rest_sum", "smoothing lattice", "volume", SUM, partial=True),
    stage("solid_volume_akinci", "volume", "melting 2.2",
           f"position phase site site_component site_link_count {NEAR}", "smoothing lattice", "volume", SUM, partial=True),
    stage("density", "density", "melting (1)", f"position phase mass volume rest_volume {NEAR}", "smoothing fluid", "density", SUM),
    stage("tait_pressure", "pressure", "melting 2.3", "phase mass volume density", "fluid", "pressure", STIFF),
    stage("boundary_pressure", "pressure", "melting 2.4", f"position phase density pressure {NEAR}", "smoothing fluid",
           "boundary_pressure", SUM),
    # ---- forces: line 5-7
    stage("fluid_force", "force", "melting (2), (3)",
           f"position velocity phase mass volume density pressure boundary_pressure {NEAR}", "smoothing fluid", "force", STIFF, partial=True),
    stage("reaction_force", "force", "melting (2), (3), Newton 3",
           f"position velocity phase mass volume density pressure boundary_pressure {NEAR}", "smoothing fluid", "force", STIFF, partial=True),
    stage("laminar_force", "viscosity", "melting 2.3, (3')",
           f"position velocity phase mass volume density {NEAR} force", "smoothing fluid", "force", SUM, partial=True),
    stage("buoyancy", "body_force", "melting 8 (Boussinesq)", "phase mass temperature force", "fluid", "force", FEW, partial=True),
    stage("drag", "body_force", "melting 2.3", "phase mass velocity force", "fluid", "force", FEW, partial=True),
    stage("surface_tension", "body_force", "melting 2.3", f"position phase mass {NEAR} force", "smoothing fluid", "force", SUM, partial=True),
    stage("xsph", "viscosity", "melting 2.3", f"position velocity phase mass density {NEAR}", "smoothing fluid", "velocity_next", SUM),
    stage("contact_force", "contact", "melting 3.3",
           f"position velocity phase mass site site_component site_link_count site_cell {NEAR} force", "contact dt", "force", STIFF, partial=True),
    # ---- phase change and topology: line 9-10
    stage("melt_test", "phase_change", "melting 3.1 rule 3",
           "material temperature latent_energy latent_capacity site_particle site_link_count material_melting_point", "lattice change",
           "site_melting melted", EXACT),
    stage("melt_particles", "phase_change", "melting 3.1 rule 4, 6",
           "site site_melting material_melts_to material_density phase material mass rest_volume density", "change",
           "phase material mass rest_volume density", FEW, partial=True),
    stage("mark_dirty", "topology", "melting 3.1 rule 5", "site_body site_melting site_region site_region_count", "lattice",
           "site_dirty body_changed", EXACT, scratch="body_changed"),
    stage("unlink", "topology", "melting 3.1 rule 4", "site_melting site_links site_link_count", "", "site_links site_link_count", EXACT, partial=True),
    stage("fill_regions", "topology", "melting 3.2", "site_links site_link_count site_dirty", "lattice",
           "site_region site_region_count", EXACT, partial=True),
    stage("components", "components", "melting 3.3", "site_links site_link_count", "", "site_component", EXACT),
    stage("crumble", "components", "melting 3.3", "site_component", "smallest", "site_melting melted component_size", EXACT),
    stage("region_share", "lattice", "melting 2.7", "mass site_particle site_region_count", "", "region_share", FEW),
    stage("region_rest", "lattice", "melting 2.7", "site_region site_region_count site_dirty region_share", "lattice", "region_mass region_rest",
           REGION, partial=True),
    # freezing: the choice of a site needs the whole neighbourhood, more than 12 arguments
    stage("freeze_choice", "freezing", "melting 3.4",
           f"position velocity phase material temperature latent_energy latent_capacity site site_adjacent site_link_count {NEAR} "
           "region_rotation region_shift material_melting_point material_freezes_to", "lattice change dt", "freeze_site freeze_distance freeze_shift", FEW),
    stage("freeze_claim", "freezing", "melting 3.4",
           f"id freeze_site freeze_distance site_particle site_adjacent site_link_count {NEAR}", "", "claim frozen", EXACT),
    stage("nucleus_choice", "nucleation", "melting 3.4",
           f"id phase material temperature latent_energy latent_capacity {NEAR} material_melting_point material_freezes_to", "change", "nucleation", EXACT),
    stage("nucleus_claim", "nucleation", "melting 3.4", "nucleation nucleus_sites site_link_count", "",
           "freeze_site claim region_rotation nucleated nucleus_count nucleus_free", COPY, partial=True, scratch="nucleus_count nucleus_free"),
    stage("freeze_particles", "freezing", "melting 3.4",
           "freeze_site freeze_shift claim material_freezes_to material_density position phase material site mass rest_volume density", "change",
           "position phase material site mass rest_volume density", FEW, partial=True),
    stage("freeze_sites", "freezing", "melting 3.4", "claim site_adjacent", "",
           "site_particle site_links site_link_count region_rotation", COPY, partial=True),
    stage("mark_frozen", "freezing", "melting 3.1 rule 5", "claim site_links site_link_count", "lattice",
           "site_dirty site_hops", EXACT, scratch="site_hops"),
    # ---- shape matching: line 11
    stage("region_match", "lattice", "melting 2.7",
           "position site_particle site_region site_region_count region_share region_mass region_rest region_rotation",
           "lattice", "site_position region_rotation region_mean region_shift", REGION),
    stage("goal", "lattice", "melting 2.7",
           "site_region site_region_count region_rotation region_mean region_shift", "lattice", "goal", REGION),
    stage("region_motion", "damping", "melting 2.7",
           "velocity site_particle site_position site_region site_region_count region_share region_mass", "",
           "site_velocity region_centre region_velocity region_spin", REGION),
    stage("damp_velocity", "damping", "melting 2.7",
           "site_particle site_position site_velocity site_region site_region_count region_centre region_velocity region_spin velocity",
           "factor", "velocity", REGION, partial=True),
    stage("rigid_match", "rigid", "melting 4 (baseline)",
           "position force mass site_particle site_component site_cell component_rotation", "lattice",
           "component_centre component_rest component_rotation component_push component_twist", REGION, partial=True),
    stage("rigid_goal", "rigid", "melting 4 (baseline)",
           "position mass site_particle site_component site_cell component_centre component_rest component_rotation component_push "
           "component_twist", "lattice", "force goal", REGION, partial=True),
    # ---- heat: line 13, eq 4 (pair stages take the enthalpy of both partners: more than 12 arguments)
    stage("thermal_properties", "heat", "melting 2.5",
           "phase material mass rest_volume volume density material_conductivity material_specific_heat", "heat",
           "conductivity heat_volume heat_capacity", FEW),
    stage("latent_properties", "heat", "melting 3.5",
           "phase material mass heat_volume heat_capacity material_specific_heat material_latent_heat material_melting_point "
           "material_melts_to material_freezes_to temperature latent_energy", "heat",
           f"heat_capacity {_LATENT} temperature latent_energy", FEW),
    stage("latent_start", "heat", "melting 3.5", "phase", "", "latent_energy", COPY),
    stage("heat_source", "heat_source", "melting 2.5",
           "position heat_volume heater_shape heater_centre heater_size heater_mode heater_value heater_reach "
           f"{_LATENT} temperature latent_energy heat_capacity", "heat dt", "temperature latent_energy heat_capacity", FEW),
    stage("ambient_cooling", "heat_source", "melting 2.5",
           f"surface neighbour_count heat_volume heat_capacity {_LATENT} temperature latent_energy", "heat dt",
           "temperature latent_energy", FEW),
    stage("heat_content", "heat_content", "melting 8 (ledgers)", f"phase heat_capacity {_LATENT} temperature latent_energy", "heat",
           "heat_content", SUM),
    stage("heat_conductance", "heat_balance", "melting 2.5", f"position conductivity heat_volume {NEAR}", "smoothing heat",
           "heat_conductance", SUM, partial=True),
    stage("heat_pairs_seq", "heat_pairs", "melting (4)",
           f"phase {_ENTHALPY} {NEAR} temperature latent_energy", "heat dt", "temperature latent_energy", SWEEP),
    stage("heat_pairs_coloured", "heat_coloured", "melting (4)",
           f"position {_THERMAL} cell_start temperature latent_energy", "smoothing grid heat dt", "temperature latent_energy", SWEEP),
    stage("heat_onesided", "heat_explicit", "melting (4)",
           f"temperature {_ENTHALPY} {NEAR} latent_energy", "heat dt reverse", "temperature_next latent_energy", SWEEP),
    stage("heat_explicit", "heat_explicit", "melting 2.5",
           f"temperature {_ENTHALPY} {NEAR} latent_energy", "heat dt", "temperature_next latent_energy", SUM),
    stage("heat_rate", "heat_explicit", "melting 2.5",
           "heat_capacity latent_capacity heat_capacity_molten heat_conductance neighbour_count", "heat", "heat_rate", SUM),
    stage("cg_guess", "heat_cg", "melting 2.5", "temperature", "", "temperature_next heat_flux", COPY),
    stage("cg_state", "heat_cg", "melting 3.5",
           f"heat_capacity {_LATENT} temperature latent_energy heat_flux temperature_next", "heat",
           "temperature_next heat_linear heat_excess", FEW),
    stage("cg_start", "heat_cg", "melting 2.5",
           f"temperature_next heat_linear heat_excess heat_conductance {NEAR}", "dt",
           "cg_residual cg_direction cg_diagonal cg_sums", SUM, partial=True),
    stage("cg_apply", "heat_cg", "melting 2.5",
           f"cg_direction heat_linear heat_conductance {NEAR} cg_sums", "dt", "cg_product cg_sums", SUM, partial=True),
    stage("cg_step", "heat_cg", "melting 2.5", "cg_direction cg_product cg_diagonal temperature_next cg_residual cg_sums", "",
           "temperature_next cg_residual cg_sums", SUM, partial=True),
    stage("cg_turn", "heat_cg", "melting 2.5", "cg_residual cg_diagonal cg_direction cg_sums", "", "cg_direction cg_sums", SUM, partial=True),
    stage("heat_balance", "heat_balance", "melting 2.5",
           f"temperature temperature_next latent_energy heat_capacity {_LATENT} heat_conductance {NEAR}", "heat dt",
           "heat_flux heat_error", SUM),
    stage("heat_finish", "heat_balance", "melting 2.5",
           f"heat_capacity {_LATENT} heat_flux temperature latent_energy", "heat", "temperature latent_energy", FEW),
    # ---- motion: line 14
    stage("kick", "motion", "melting 2.6", "phase mass force velocity", "dt", "velocity", FEW, partial=True),
    stage("goal_kick", "motion", "melting 2.6", "site_particle goal velocity", "lattice dt", "velocity", FEW, partial=True),
    stage("goal_move", "motion", "melting 2.7", "site_particle goal position", "lattice", "position", FEW, partial=True),
    stage("drift", "motion", "melting 2.6", "phase velocity position", "dt", "position", FEW, partial=True),
    stage("guard_offenders", "guard", "melting 2.4", f"position phase {NEAR}", "guard", "offenders", EXACT),
    stage("guard_correction", "guard", "melting 2.4", f"position velocity phase mass offenders {NEAR}", "guard",
           "position_next velocity_next", SUM),
    stage("leave_domain", "motion", "melting 6", "position phase", "domain", "phase", EXACT, partial=True),
    stage("motion_bounds", "motion", "melting 2.6", "phase mass velocity force", "", "motion_bounds", FEW),
    *BOILING,
    *FLOOD,
    *SLIME,
    # ---- surface: line 15
    stage("surface", "surface", "melting 2.8", f"position phase volume {NEAR}", "smoothing full_neighbours", "surface", EXACT),
    stage("surface_field", "surface_field", "melting 2.8", "position temperature cell_start surface_node", "grid reconstruction",
           "surface_distance surface_temperature", EIGEN),
    *SCREEN,
]

STAGES = {entry.name: entry for entry in _LIST}
