"""Registry entries of the position based fluid and of boiling, in pipeline order (see `melt.stages`)."""

from melt.registry import COPY, EXACT, FEW, NEAR, SHARE, STIFF, SUM, stage

LIST = [
    # ---- position based fluid: solve
    stage("pbf_predict", "pbf_motion", "boiling S2", "phase velocity position", "fluid pbf vessel dt", "velocity position position_predicted", FEW,
           partial=True),
    stage("pbf_begin", "pbf_lists", "boiling 2.1", "phase mass rest_volume", "", "volume mobility constraint multiplier", FEW),
    stage("pbf_list", "pbf_lists", "boiling 2.6", f"position support_radius {NEAR}", "pbf", NEAR, EXACT, partial=True),
    stage("pbf_separate", "pbf_lists", "boiling 6", f"position id mobility {NEAR}", "pbf", "correction", FEW),
    stage("pbf_lambda", "pbf", "boiling (1), (4), (5)",
           f"position volume mobility support_radius kernel_scale {NEAR} active_index active_count", "pbf", "constraint multiplier",
           STIFF, partial=True),
    # both partners' share in the solve, their lists, and which of the pairs act
    stage("pbf_correction", "pbf", "boiling (6)",
           f"position volume mobility support_radius iterations multiplier kernel_scale {NEAR} active_index active_count",
           "pbf iteration", "correction", STIFF, partial=True),
    # the solve and contact at once: both partners, lists, and which body a particle is of
    stage("solid_correction", "pbf_solid", "boiling (6), Newton 3; melting 3.3",
           f"position phase mass volume multiplier support_radius kernel_scale site site_component {NEAR} solid_index solid_count", "pbf",
           "correction", STIFF, partial=True),
    stage("pbf_move", "pbf_motion", "boiling S4c", "correction active_index active_count position", "pbf vessel", "position", FEW, partial=True),
    # ---- position based fluid: velocities
    stage("pbf_velocity", "pbf_motion", "boiling S5", "position position_predicted phase velocity", "dt", "velocity", FEW, partial=True),
    stage("vorticity_curl", "vorticity", "boiling (7)", f"position velocity phase volume support_radius kernel_scale {NEAR}", "pbf",
           "vorticity", STIFF),
    stage("vorticity_force", "vorticity", "boiling (7)", f"position vorticity phase volume support_radius kernel_scale {NEAR} velocity",
           "pbf dt", "velocity", STIFF, partial=True),
    stage("pbf_xsph", "vorticity", "boiling (8)", f"position velocity phase mass volume support_radius {NEAR}", "pbf dt",
           "velocity_next", SUM),
    stage("pbf_bounds", "pbf_motion", "boiling 6", "phase velocity constraint", "", "pbf_bounds", FEW),
    # ---- effect precision
    stage("height_histogram", "precision", "boiling 2.6", "position phase", "pbf", "height_bins", EXACT),
    stage("momentum_size", "precision", "boiling (15)", "phase mass velocity", "", "momentum_size", FEW),
    stage("effect_precision", "precision", "boiling (15)", f"position phase momentum_size {NEAR} effect_precision", "pbf height dt",
           "effect_precision support_radius iterations", FEW),
    stage("iteration_key", "precision", "boiling 2.6", f"phase iterations {NEAR}", "pbf", "iteration_key", EXACT),
    stage("active_list", "precision", "boiling 2.6", "iteration_key", "iteration", "active_index active_count chunk_sum", EXACT,
           scratch="chunk_sum"),
    # ---- boiling: lists (fields are named by the page: index and count of what is listed)
    stage("list_slots", "lists", "boiling 3", "flag", "key", "index count chunk_sum", EXACT, scratch="chunk_sum"),
    stage("order_by_id", "lists", "boiling 3", "id count", "", "index list_scratch", EXACT, partial=True, scratch="list_scratch"),
    # ---- boiling: heat of the liquid
    stage("boil_sums", "boil_heat", "boiling (11)", f"position phase rest_volume support_radius {NEAR}", "pbf", "heat_sum", SUM),
    stage("boil_rate", "boil_heat", "boiling 2.3",
           f"position phase rest_volume constraint support_radius heat_sum {NEAR}", "pbf boiling", "heat_rate", SUM),
    stage("boil_exchange", "boil_heat", "boiling (10), (11)",
           f"temperature position phase rest_volume constraint support_radius heat_sum {NEAR}", "pbf boiling dt", "temperature_next", SUM),
    stage("boil_heater", "boil_heat", "boiling 2.3", "position phase mass temperature", "bubbles boiling target share", "temperature heater_heat", SUM,
           partial=True),
    stage("boil_cooling", "boil_heat", "boiling 2.3", "position phase mass temperature", "bubbles boiling target share height", "temperature lost_heat", SUM,
           partial=True),
    stage("boil_store", "boil_heat", "boiling 3", "phase temperature latent_store", "boiling", "temperature latent_store", FEW, partial=True),
    stage("boil_content", "boil_heat", "boiling 3 (ledger)", "phase mass temperature latent_store", "boiling", "boil_content", SUM),
    stage("voxel_heat", "boil_grid", "boiling (9)", "voxel_temperature", "tank dt", "voxel_temperature_next", FEW),
    stage("voxel_heater", "boil_grid", "boiling (9)", "voxel_temperature", "tank boiling target share", "voxel_temperature heater_heat", SUM, partial=True),
    stage("voxel_sample", "boil_grid", "boiling (9)", "voxel_temperature position phase", "tank boiling", "temperature", FEW, partial=True),
    # ---- boiling: velocity boost
    stage("liquid_sums", "boost", "boiling 2.4", "phase mass velocity temperature", "", "liquid_sums", SUM),
    stage("boost", "boost", "boiling (12)", "phase temperature velocity", "fluid boiling mean_u mean_v mean_w mean_temperature dt", "velocity", FEW,
           partial=True),
    stage("shift_velocity", "boost", "boiling (12)", "phase velocity", "mean_u mean_v mean_w", "velocity", FEW, partial=True),
    stage("boost_xsph", "boost", "boiling (8), (12)", f"position velocity phase mass volume temperature support_radius {NEAR}", "pbf dt",
           "velocity_next", SUM),
    # ---- boiling: birth of bubbles
    stage("boil_candidates", "bubble_birth", "boiling 3", "id phase temperature latent_store", "boiling step_low step_high", "candidate", EXACT),
    stage("boiled_sums", "bubble_birth", "boiling 3 (ledger)", "birth_index mass temperature latent_store latent_energy", "boiling served",
           "boiled_sums", SUM),
    # one particle becomes four bubbles in slots of their own: all their fields
    stage("spawn_bubbles", "bubble_birth", "boiling 3", "birth_index free_index",
           "boiling bubbles step_low step_high first_id served",
           "phase id position velocity mass rest_volume temperature latent_store bubble_volume bubble_radius birth_height age cargo birth_excess",
           FEW, partial=True),
    # ---- boiling: bubbles on the move
    stage("bubble_predict", "bubble_motion", "boiling 2.5", "bubble_index bubble_count bubble_radius", "bubbles dt", "velocity position", FEW,
           partial=True),
    stage("bubble_exclude", "bubble_motion", "boiling 2.5", "phase bubble_index bubble_count bubble_radius", "pbf vessel", "position", FEW,
           partial=True),
    # the bubbles' list beside that of their neighbours
    stage("bubble_drag", "bubble_motion", "boiling 2.5",
           f"position phase bubble_index bubble_count bubble_radius support_radius {NEAR}", "pbf bubbles dt",
           "velocity bubble_push", SHARE, partial=True),
    stage("bubble_reaction", "bubble_motion", "boiling 2.5", f"position phase mass support_radius bubble_push {NEAR}", "pbf", "velocity", SUM,
           partial=True),
    stage("bubble_move", "bubble_motion", "boiling 2.5", "bubble_index bubble_count bubble_radius velocity position_predicted", "bubbles dt",
           "position", FEW, partial=True),
    stage("bubble_drift", "bubble_motion", "boiling (13)", f"position phase bubble_index bubble_count {NEAR}", "bubbles dt", "bubble_shift", FEW,
           partial=True),
    stage("bubble_shift", "bubble_motion", "boiling (13)", "bubble_index bubble_count bubble_radius bubble_shift", "bubbles", "position", FEW,
           partial=True),
    stage("bubble_avoid", "bubble_motion", "boiling 2.5", f"position phase bubble_index bubble_count bubble_radius {NEAR}", "bubbles",
           "position", FEW, partial=True),
    stage("bubble_growth", "bubble_growth", "boiling 2.5", "position bubble_index bubble_count bubble_volume birth_height", "bubbles dt",
           "age bubble_radius rest_volume", FEW, partial=True),
    stage("largest_bubble", "bubble_growth", "boiling 2.5", "phase bubble_radius", "", "largest_bubble", COPY),
    # ---- boiling: merging and bursting
    stage("bubble_cell", "bubble_merge", "boiling 3", "position phase", "grid coarse", "bubble_cell", EXACT),
    stage("merge_label", "bubble_merge", "boiling 3",
           "position bubble_radius age bubble_index bubble_count bubble_cell bubble_order bubble_start", "grid bubbles coarse",
           "merge_root merge_size", EXACT),
    # a bubble's whole state: more than 12 arguments
    stage("merge_bubbles", "bubble_merge", "boiling 2.5", "bubble_index bubble_count merge_root merge_size", "bubbles",
           "phase position velocity rest_volume bubble_volume bubble_radius birth_height age cargo merge_removed", FEW, partial=True),
    stage("surface_column", "bubble_burst", "boiling 2.5", "position phase", "grid bubbles", "surface_column", EXACT),
    stage("burst_test", "bubble_burst", "boiling 2.5", "position bubble_radius bubble_index bubble_count surface_column", "grid bubbles height",
           "bubble_fate burst_top", FEW),
    stage("burst_push", "bubble_burst", "boiling (14)", "position phase burst_index burst_count burst_top", "bubbles", "velocity", FEW,
           partial=True),
    stage("remove_bubbles", "bubble_burst", "boiling 3", "bubble_index bubble_count bubble_fate cargo", "", "phase released", EXACT, partial=True),
    # ---- boiling: condensate
    # a particle that comes into being: all its fields
    stage("condense", "condense", "boiling 3", "surface_column free_index",
           "grid bubbles boiling pbf condensate step_low step_high first_id served",
           "phase id position velocity mass rest_volume temperature latent_store bubble_radius age cargo "
           "effect_precision support_radius iterations", FEW, partial=True),
    # ---- boiling: vapour
    # a particle that comes into being: all its fields
    stage("vapour_source", "vapour", "boiling 2.6", "position burst_index burst_top free_index", "vapour boiling step_low step_high first_id served",
           "phase id position velocity mass rest_volume temperature age vapour_support", FEW, partial=True),
    stage("vapour_density", "vapour", "boiling 2.6", f"position phase vapour_support {NEAR}", "vapour", "vapour_density vapour_pressure", SUM,
           partial=True),
    stage("vapour_force", "vapour", "boiling (16)",
           f"position phase temperature vapour_density vapour_pressure vapour_support {NEAR}", "vapour dt", "velocity vapour_push", STIFF,
           partial=True),
    stage("vapour_move", "vapour", "boiling 2.6", "velocity", "bubbles vapour dt", "phase position age", FEW, partial=True),
    stage("vapour_precision", "vapour", "boiling (16)", f"phase vapour_density vapour_push {NEAR}", "vapour", "vapour_support", FEW, partial=True),
    # ---- weakly compressible SPH of Mueller 2003, baseline of boiling's Table 1
    stage("sph_density", "sph", "boiling 1", f"position phase rest_volume {NEAR}", "sph", "density pressure constraint", SUM),
    stage("sph_force", "sph", "boiling 1", f"position velocity phase rest_volume density pressure {NEAR}", "sph dt", "velocity_next", STIFF),
]
