"""The registry: one entry per stage, in pipeline order.

Plan, binders, cross-check, ``docs/stages.md`` and the law tests derive from it; there is
no second list. A stage's arguments are, in this order: fields it only reads, parameters
(NamedTuples of `melt.params` in lower case, then scalars such as ``dt``), fields it writes.
A field that is read and written stands among the written ones.
"""

from typing import NamedTuple


class Tolerance(NamedTuple):
    """``|a - b| <= rtol * |ref| + atol * field.scale``, per precision, with its reason."""

    single: float
    double: float
    reason: str
    atol_single: float | None = None  # None: as rtol
    atol_double: float | None = None

    def of(self, precision):
        """Return (rtol, atol) for ``single`` (also pair work of ``mixed``) or ``double``."""
        if precision == "double":
            return self.double, self.double if self.atol_double is None else self.atol_double
        return self.single, self.single if self.atol_single is None else self.atol_single


class Stage(NamedTuple):
    name: str
    file: str
    equation: str
    reads: tuple
    params: tuple
    writes: tuple
    tolerance: Tolerance
    partial: bool  # writes a subset of the elements: the others keep their value
    scratch: tuple  # fields among ``writes`` whose contents mean nothing afterwards

    @property
    def arguments(self):
        """Names of the arguments in order."""
        return tuple(r for r in self.reads if r not in self.writes) + self.params + self.writes


_EXACT = Tolerance(0.0, 0.0, "integers, compared exactly")
_COPY = Tolerance(0.0, 0.0, "copies values")
_SUM = Tolerance(2e-5, 1e-12, "sum of about 80 products; float32 positions are rounded")
_STIFF = Tolerance(2e-4, 1e-11, "seventh power and differences of nearly equal terms")
_FEW = Tolerance(2e-6, 1e-14, "a few operations per element")
_SHARE = Tolerance(1e-3, 1e-12, "divided by a sum of weights, of which few digits are left if all neighbours are near the support")
_REGION = Tolerance(5e-5, 1e-11, "sum over up to 125 members and a rotation")
_SWEEP = Tolerance(5e-5, 1e-11, "a chain of pair updates")
_EIGEN = Tolerance(2e-4, 1e-8, "closed-form eigenvalue: a double root has half the digits")
_SOLVER = Tolerance(1e-4, 1e-7, "iterated to its own residual tolerance")


def _stage(name, file, equation, reads, params, writes, tolerance, partial=False, scratch=""):
    return Stage(
        name, file, equation, tuple(reads.split()), tuple(params.split()), tuple(writes.split()),
        tolerance, partial, tuple(scratch.split()),
    )


_NEAR = "neighbour_count neighbour_index"
_LATENT = "heat_capacity_molten latent_point latent_capacity"
_THERMAL = f"conductivity heat_volume heat_capacity {_LATENT}"
_ENTHALPY = f"heat_capacity {_LATENT} heat_conductance"
_LIST = [
    # ---- inflow: new particles into the inactive slots that follow the sorted active ones
    _stage("emit_motion", "inflow", "melting 1 stage 0", "inflow_position inflow_velocity phase position velocity latent_energy",
           "first count slot lag", "phase position velocity latent_energy", _FEW, partial=True),
    _stage("emit_matter", "inflow", "melting 1 stage 0", "inflow_mass inflow_volume inflow_temperature inflow_material"
           " mass rest_volume temperature material site", "first count slot", "mass rest_volume temperature material site", _COPY, partial=True),
    # ---- neighbours: line 1-2
    _stage("cell_index", "grid", "melting 2.9", "position phase", "grid", "cell", _EXACT),
    _stage("cell_sort", "grid", "melting 2.9", "cell", "", "order cell_start arrival chunk_sum", _EXACT, scratch="arrival chunk_sum"),
    _stage("reorder_scalar", "grid", "melting 2.9", "order source", "", "target", _COPY),
    _stage("reorder_vector", "grid", "melting 2.9", "order source", "", "target", _COPY),
    _stage("site_particle", "grid", "melting 2.9", "phase site", "", "site_particle", _EXACT),
    _stage("neighbours_grid", "neighbours", "melting 2.9", "position phase cell_start", "grid smoothing", _NEAR, _EXACT),
    _stage("kdtree_build", "kdtree", "melting 2.9", "position", "", "tree tree_rank", _EXACT, scratch="tree_rank"),
    _stage("neighbours_kdtree", "kdtree", "melting 2.9", "position phase tree", "smoothing", _NEAR, _EXACT),
    # ---- SPH volumes, density, pressure: line 4
    _stage("liquid_volume", "volume", "melting 2.2", "phase rest_volume", "fluid", "volume", _COPY),
    _stage("rest_sum", "volume", "melting 2.2", "site_rest site_region site_region_count", "smoothing", "rest_sum", _SUM),
    _stage("solid_volume_rest", "volume", "melting 2.2",
           "position rest_volume site_particle site_region site_region_count rest_sum", "smoothing lattice", "volume", _SUM, partial=True),
    _stage("solid_volume_akinci", "volume", "melting 2.2",
           f"position phase site site_component site_link_count {_NEAR}", "smoothing lattice", "volume", _SUM, partial=True),
    _stage("density", "density", "melting (1)", f"position phase mass volume rest_volume {_NEAR}", "smoothing fluid", "density", _SUM),
    _stage("tait_pressure", "pressure", "melting 2.3", "phase mass volume density", "fluid", "pressure", _STIFF),
    _stage("boundary_pressure", "pressure", "melting 2.4", f"position phase density pressure {_NEAR}", "smoothing fluid",
           "boundary_pressure", _SUM),
    # ---- forces: line 5-7
    _stage("fluid_force", "force", "melting (2), (3)",
           f"position velocity phase mass volume density pressure boundary_pressure {_NEAR}", "smoothing fluid", "force", _STIFF, partial=True),
    _stage("reaction_force", "force", "melting (2), (3), Newton 3",
           f"position velocity phase mass volume density pressure boundary_pressure {_NEAR}", "smoothing fluid", "force", _STIFF, partial=True),
    _stage("laminar_force", "viscosity", "melting 2.3, (3')",
           f"position velocity phase mass volume density {_NEAR} force", "smoothing fluid", "force", _SUM, partial=True),
    _stage("buoyancy", "body_force", "melting 8 (Boussinesq)", "phase mass temperature force", "fluid", "force", _FEW, partial=True),
    _stage("drag", "body_force", "melting 2.3", "phase mass velocity force", "fluid", "force", _FEW, partial=True),
    _stage("surface_tension", "body_force", "melting 2.3", f"position phase mass {_NEAR} force", "smoothing fluid", "force", _SUM, partial=True),
    _stage("xsph", "viscosity", "melting 2.3", f"position velocity phase mass density {_NEAR}", "smoothing fluid", "velocity_next", _SUM),
    _stage("contact_force", "contact", "melting 3.3",
           f"position velocity phase mass site site_component site_link_count site_cell {_NEAR} force", "contact dt", "force", _STIFF, partial=True),
    # ---- phase change and topology: line 9-10
    _stage("melt_test", "phase_change", "melting 3.1 rule 3",
           "material temperature latent_energy latent_capacity site_particle site_link_count material_melting_point", "lattice change",
           "site_melting melted", _EXACT),
    _stage("melt_particles", "phase_change", "melting 3.1 rule 4, 6",
           "site site_melting material_melts_to material_density phase material mass rest_volume density", "change",
           "phase material mass rest_volume density", _FEW, partial=True),
    _stage("mark_dirty", "topology", "melting 3.1 rule 5", "site_body site_melting site_region site_region_count", "lattice",
           "site_dirty body_changed", _EXACT, scratch="body_changed"),
    _stage("unlink", "topology", "melting 3.1 rule 4", "site_melting site_links site_link_count", "", "site_links site_link_count", _EXACT, partial=True),
    _stage("fill_regions", "topology", "melting 3.2", "site_links site_link_count site_dirty", "lattice",
           "site_region site_region_count", _EXACT, partial=True),
    _stage("components", "components", "melting 3.3", "site_links site_link_count", "", "site_component", _EXACT),
    _stage("crumble", "components", "melting 3.3", "site_component", "smallest", "site_melting melted component_size", _EXACT),
    _stage("region_share", "lattice", "melting 2.7", "mass site_particle site_region_count", "", "region_share", _FEW),
    _stage("region_rest", "lattice", "melting 2.7", "site_region site_region_count site_dirty region_share", "lattice", "region_mass region_rest",
           _REGION, partial=True),
    # freezing: the choice of a site needs the whole neighbourhood, more than 12 arguments
    _stage("freeze_choice", "freezing", "melting 3.4",
           f"position velocity phase material temperature latent_energy latent_capacity site site_adjacent site_link_count {_NEAR} "
           "region_rotation region_shift material_melting_point material_freezes_to", "lattice change dt", "freeze_site freeze_distance freeze_shift", _FEW),
    _stage("freeze_claim", "freezing", "melting 3.4",
           f"id freeze_site freeze_distance site_particle site_adjacent site_link_count {_NEAR}", "", "claim frozen", _EXACT),
    _stage("nucleus_choice", "nucleation", "melting 3.4",
           f"id phase material temperature latent_energy latent_capacity {_NEAR} material_melting_point material_freezes_to", "change", "nucleation", _EXACT),
    _stage("nucleus_claim", "nucleation", "melting 3.4", "nucleation nucleus_sites site_link_count", "",
           "freeze_site claim region_rotation nucleated nucleus_count nucleus_free", _COPY, partial=True, scratch="nucleus_count nucleus_free"),
    _stage("freeze_particles", "freezing", "melting 3.4",
           "freeze_site freeze_shift claim material_freezes_to material_density position phase material site mass rest_volume density", "change",
           "position phase material site mass rest_volume density", _FEW, partial=True),
    _stage("freeze_sites", "freezing", "melting 3.4", "claim site_adjacent", "",
           "site_particle site_links site_link_count region_rotation", _COPY, partial=True),
    _stage("mark_frozen", "freezing", "melting 3.1 rule 5", "claim site_links site_link_count", "lattice",
           "site_dirty site_hops", _EXACT, scratch="site_hops"),
    # ---- shape matching: line 11
    _stage("region_match", "lattice", "melting 2.7",
           "position site_particle site_region site_region_count region_share region_mass region_rest region_rotation",
           "lattice", "site_position region_rotation region_mean region_shift", _REGION),
    _stage("goal", "lattice", "melting 2.7",
           "site_region site_region_count region_rotation region_mean region_shift", "lattice", "goal", _REGION),
    _stage("region_motion", "damping", "melting 2.7",
           "velocity site_particle site_position site_region site_region_count region_share region_mass", "",
           "site_velocity region_centre region_velocity region_spin", _REGION),
    _stage("damp_velocity", "damping", "melting 2.7",
           "site_particle site_position site_velocity site_region site_region_count region_centre region_velocity region_spin velocity",
           "factor", "velocity", _REGION, partial=True),
    _stage("rigid_match", "rigid", "melting 4 (baseline)",
           "position force mass site_particle site_component site_cell component_rotation", "lattice",
           "component_centre component_rest component_rotation component_push component_twist", _REGION, partial=True),
    _stage("rigid_goal", "rigid", "melting 4 (baseline)",
           "position mass site_particle site_component site_cell component_centre component_rest component_rotation component_push "
           "component_twist", "lattice", "force goal", _REGION, partial=True),
    # ---- heat: line 13, eq 4 (pair stages take the enthalpy of both partners: more than 12 arguments)
    _stage("thermal_properties", "heat", "melting 2.5",
           "phase material mass rest_volume volume density material_conductivity material_specific_heat", "heat",
           "conductivity heat_volume heat_capacity", _FEW),
    _stage("latent_properties", "heat", "melting 3.5",
           "phase material mass heat_volume heat_capacity material_specific_heat material_latent_heat material_melting_point "
           "material_melts_to material_freezes_to temperature latent_energy", "heat",
           f"heat_capacity {_LATENT} temperature latent_energy", _FEW),
    _stage("latent_start", "heat", "melting 3.5", "phase", "", "latent_energy", _COPY),
    _stage("heat_source", "heat_source", "melting 2.5",
           "position heat_volume heater_shape heater_centre heater_size heater_mode heater_value heater_reach "
           f"{_LATENT} temperature latent_energy heat_capacity", "heat dt", "temperature latent_energy heat_capacity", _FEW),
    _stage("ambient_cooling", "heat_source", "melting 2.5",
           f"surface neighbour_count heat_volume heat_capacity {_LATENT} temperature latent_energy", "heat dt",
           "temperature latent_energy", _FEW),
    _stage("heat_content", "heat_content", "melting 8 (ledgers)", f"phase heat_capacity {_LATENT} temperature latent_energy", "heat",
           "heat_content", _SUM),
    _stage("heat_conductance", "heat_balance", "melting 2.5", f"position conductivity heat_volume {_NEAR}", "smoothing heat",
           "heat_conductance", _SUM, partial=True),
    _stage("heat_pairs_seq", "heat_pairs", "melting (4)",
           f"phase {_ENTHALPY} {_NEAR} temperature latent_energy", "heat dt", "temperature latent_energy", _SWEEP),
    _stage("heat_pairs_coloured", "heat_coloured", "melting (4)",
           f"position {_THERMAL} cell_start temperature latent_energy", "smoothing grid heat dt", "temperature latent_energy", _SWEEP),
    _stage("heat_onesided", "heat_explicit", "melting (4)",
           f"temperature {_ENTHALPY} {_NEAR} latent_energy", "heat dt reverse", "temperature_next latent_energy", _SWEEP),
    _stage("heat_explicit", "heat_explicit", "melting 2.5",
           f"temperature {_ENTHALPY} {_NEAR} latent_energy", "heat dt", "temperature_next latent_energy", _SUM),
    _stage("heat_rate", "heat_explicit", "melting 2.5",
           "heat_capacity latent_capacity heat_capacity_molten heat_conductance neighbour_count", "heat", "heat_rate", _SUM),
    _stage("cg_guess", "heat_cg", "melting 2.5", "temperature", "", "temperature_next heat_flux", _COPY),
    _stage("cg_state", "heat_cg", "melting 3.5",
           f"heat_capacity {_LATENT} temperature latent_energy heat_flux temperature_next", "heat",
           "temperature_next heat_linear heat_excess", _FEW),
    _stage("cg_start", "heat_cg", "melting 2.5",
           f"temperature_next heat_linear heat_excess heat_conductance {_NEAR}", "dt",
           "cg_residual cg_direction cg_diagonal cg_sums", _SUM, partial=True),
    _stage("cg_apply", "heat_cg", "melting 2.5",
           f"cg_direction heat_linear heat_conductance {_NEAR} cg_sums", "dt", "cg_product cg_sums", _SUM, partial=True),
    _stage("cg_step", "heat_cg", "melting 2.5", "cg_direction cg_product cg_diagonal temperature_next cg_residual cg_sums", "",
           "temperature_next cg_residual cg_sums", _SUM, partial=True),
    _stage("cg_turn", "heat_cg", "melting 2.5", "cg_residual cg_diagonal cg_direction cg_sums", "", "cg_direction cg_sums", _SUM, partial=True),
    _stage("heat_balance", "heat_balance", "melting 2.5",
           f"temperature temperature_next latent_energy heat_capacity {_LATENT} heat_conductance {_NEAR}", "heat dt",
           "heat_flux heat_error", _SUM),
    _stage("heat_finish", "heat_balance", "melting 2.5",
           f"heat_capacity {_LATENT} heat_flux temperature latent_energy", "heat", "temperature latent_energy", _FEW),
    # ---- motion: line 14
    _stage("kick", "motion", "melting 2.6", "phase mass force velocity", "dt", "velocity", _FEW, partial=True),
    _stage("goal_kick", "motion", "melting 2.6", "site_particle goal velocity", "lattice dt", "velocity", _FEW, partial=True),
    _stage("drift", "motion", "melting 2.6", "phase velocity position", "dt", "position", _FEW, partial=True),
    _stage("guard_offenders", "guard", "melting 2.4", f"position phase {_NEAR}", "guard", "offenders", _EXACT),
    _stage("guard_correction", "guard", "melting 2.4", f"position velocity phase mass offenders {_NEAR}", "guard",
           "position_next velocity_next", _SUM),
    _stage("leave_domain", "motion", "melting 6", "position phase", "domain", "phase", _EXACT, partial=True),
    _stage("motion_bounds", "motion", "melting 2.6", "phase mass velocity force", "", "motion_bounds", _FEW),
    # ---- position based fluid: solve
    _stage("pbf_predict", "pbf_motion", "boiling S2", "phase velocity position", "fluid pbf vessel dt", "velocity position position_predicted", _FEW,
           partial=True),
    _stage("pbf_begin", "pbf_lists", "boiling 2.1", "phase mass rest_volume", "", "volume mobility constraint multiplier", _FEW),
    _stage("pbf_list", "pbf_lists", "boiling 2.6", f"position support_radius {_NEAR}", "pbf", _NEAR, _EXACT, partial=True),
    _stage("pbf_separate", "pbf_lists", "boiling 6", f"position id mobility {_NEAR}", "pbf", "correction", _FEW),
    _stage("pbf_lambda", "pbf", "boiling (1), (4), (5)",
           f"position volume mobility support_radius kernel_scale {_NEAR} active_index active_count", "pbf", "constraint multiplier",
           _STIFF, partial=True),
    # both partners' share in the solve, their lists, and which of the pairs act
    _stage("pbf_correction", "pbf", "boiling (6)",
           f"position volume mobility support_radius iterations multiplier kernel_scale {_NEAR} active_index active_count",
           "pbf iteration", "correction", _STIFF, partial=True),
    _stage("pbf_move", "pbf_motion", "boiling S4c", "correction active_index active_count position", "vessel", "position", _FEW, partial=True),
    # ---- position based fluid: velocities
    _stage("pbf_velocity", "pbf_motion", "boiling S5", "position position_predicted phase velocity", "dt", "velocity", _FEW, partial=True),
    _stage("vorticity_curl", "vorticity", "boiling (7)", f"position velocity phase volume support_radius kernel_scale {_NEAR}", "pbf",
           "vorticity", _STIFF),
    _stage("vorticity_force", "vorticity", "boiling (7)", f"position vorticity phase volume support_radius kernel_scale {_NEAR} velocity",
           "pbf dt", "velocity", _STIFF, partial=True),
    _stage("pbf_xsph", "vorticity", "boiling (8)", f"position velocity phase mass volume support_radius {_NEAR}", "pbf dt",
           "velocity_next", _SUM),
    _stage("pbf_bounds", "pbf_motion", "boiling 6", "phase velocity constraint", "", "pbf_bounds", _FEW),
    # ---- effect precision
    _stage("height_histogram", "precision", "boiling 2.6", "position phase", "pbf", "height_bins", _EXACT),
    _stage("effect_precision", "precision", "boiling (15)", f"position velocity phase mass {_NEAR} effect_precision", "pbf height dt",
           "effect_precision support_radius iterations", _FEW),
    _stage("iteration_key", "precision", "boiling 2.6", f"phase iterations {_NEAR}", "pbf", "iteration_key", _EXACT),
    _stage("active_list", "precision", "boiling 2.6", "iteration_key", "iteration", "active_index active_count chunk_sum", _EXACT,
           scratch="chunk_sum"),
    # ---- boiling: lists (fields are named by the page: index and count of what is listed)
    _stage("list_slots", "lists", "boiling 3", "flag", "key", "index count chunk_sum", _EXACT, scratch="chunk_sum"),
    _stage("order_by_id", "lists", "boiling 3", "id count", "", "index list_scratch", _EXACT, partial=True, scratch="list_scratch"),
    # ---- boiling: heat of the liquid
    _stage("boil_sums", "boil_heat", "boiling (11)", f"position phase rest_volume support_radius {_NEAR}", "pbf", "heat_sum", _SUM),
    _stage("boil_rate", "boil_heat", "boiling 2.3",
           f"position phase rest_volume constraint support_radius heat_sum {_NEAR}", "pbf boiling", "heat_rate", _SUM),
    _stage("boil_exchange", "boil_heat", "boiling (10), (11)",
           f"temperature position phase rest_volume constraint support_radius heat_sum {_NEAR}", "pbf boiling dt", "temperature_next", _SUM),
    _stage("boil_heater", "boil_heat", "boiling 2.3", "position phase mass temperature", "bubbles boiling target share", "temperature heater_heat", _SUM,
           partial=True),
    _stage("boil_cooling", "boil_heat", "boiling 2.3", "position phase mass temperature", "bubbles boiling target share height", "temperature lost_heat", _SUM,
           partial=True),
    _stage("boil_store", "boil_heat", "boiling 3", "phase temperature latent_store", "boiling", "temperature latent_store", _FEW, partial=True),
    _stage("boil_content", "boil_heat", "boiling 3 (ledger)", "phase mass temperature latent_store", "boiling", "boil_content", _SUM),
    _stage("voxel_heat", "boil_grid", "boiling (9)", "voxel_temperature", "tank dt", "voxel_temperature_next", _FEW),
    _stage("voxel_heater", "boil_grid", "boiling (9)", "voxel_temperature", "tank boiling target share", "voxel_temperature heater_heat", _SUM, partial=True),
    _stage("voxel_sample", "boil_grid", "boiling (9)", "voxel_temperature position phase", "tank boiling", "temperature", _FEW, partial=True),
    # ---- boiling: velocity boost
    _stage("liquid_sums", "boost", "boiling 2.4", "phase mass velocity temperature", "", "liquid_sums", _SUM),
    _stage("boost", "boost", "boiling (12)", "phase temperature velocity", "fluid boiling mean_u mean_v mean_w mean_temperature dt", "velocity", _FEW,
           partial=True),
    _stage("shift_velocity", "boost", "boiling (12)", "phase velocity", "mean_u mean_v mean_w", "velocity", _FEW, partial=True),
    _stage("boost_xsph", "boost", "boiling (8), (12)", f"position velocity phase mass volume temperature support_radius {_NEAR}", "pbf dt",
           "velocity_next", _SUM),
    # ---- boiling: birth of bubbles
    _stage("boil_candidates", "bubble_birth", "boiling 3", "id phase temperature latent_store", "boiling step_low step_high", "candidate", _EXACT),
    # one particle becomes four bubbles in slots of their own: all their fields
    _stage("spawn_bubbles", "bubble_birth", "boiling 3", "birth_index free_index",
           "boiling bubbles step_low step_high first_id served",
           "phase id position velocity mass rest_volume temperature latent_store bubble_volume bubble_radius birth_height age cargo birth_excess",
           _FEW, partial=True),
    # ---- boiling: bubbles on the move
    _stage("bubble_predict", "bubble_motion", "boiling 2.5", "bubble_index bubble_count bubble_radius", "bubbles dt", "velocity position", _FEW,
           partial=True),
    _stage("bubble_exclude", "bubble_motion", "boiling 2.5", "phase bubble_index bubble_count bubble_radius", "pbf vessel", "position", _FEW,
           partial=True),
    # the bubbles' list beside that of their neighbours
    _stage("bubble_drag", "bubble_motion", "boiling 2.5",
           f"position phase bubble_index bubble_count bubble_radius support_radius {_NEAR}", "pbf bubbles dt",
           "velocity bubble_push", _SHARE, partial=True),
    _stage("bubble_reaction", "bubble_motion", "boiling 2.5", f"position phase mass support_radius bubble_push {_NEAR}", "pbf", "velocity", _SUM,
           partial=True),
    _stage("bubble_move", "bubble_motion", "boiling 2.5", "bubble_index bubble_count bubble_radius velocity position_predicted", "bubbles dt",
           "position", _FEW, partial=True),
    _stage("bubble_drift", "bubble_motion", "boiling (13)", f"position phase bubble_index bubble_count {_NEAR}", "bubbles dt", "bubble_shift", _FEW,
           partial=True),
    _stage("bubble_shift", "bubble_motion", "boiling (13)", "bubble_index bubble_count bubble_radius bubble_shift", "bubbles", "position", _FEW,
           partial=True),
    _stage("bubble_growth", "bubble_growth", "boiling 2.5", "position bubble_index bubble_count bubble_volume birth_height", "bubbles dt",
           "age bubble_radius rest_volume", _FEW, partial=True),
    _stage("largest_bubble", "bubble_growth", "boiling 2.5", "phase bubble_radius", "", "largest_bubble", _COPY),
    # ---- boiling: merging and bursting
    _stage("bubble_cell", "bubble_merge", "boiling 3", "position phase", "grid coarse", "bubble_cell", _EXACT),
    _stage("merge_label", "bubble_merge", "boiling 3",
           "position bubble_radius age bubble_index bubble_count bubble_cell bubble_order bubble_start", "grid bubbles coarse",
           "merge_root merge_size", _EXACT),
    # a bubble's whole state: more than 12 arguments
    _stage("merge_bubbles", "bubble_merge", "boiling 2.5", "bubble_index bubble_count merge_root merge_size", "bubbles",
           "phase position velocity rest_volume bubble_volume bubble_radius birth_height age cargo merge_removed", _FEW, partial=True),
    _stage("surface_column", "bubble_burst", "boiling 2.5", "position phase", "grid bubbles", "surface_column", _EXACT),
    _stage("burst_test", "bubble_burst", "boiling 2.5", "position bubble_radius bubble_index bubble_count surface_column", "grid bubbles height",
           "bubble_fate burst_top", _FEW),
    _stage("burst_push", "bubble_burst", "boiling (14)", "position phase burst_index burst_count burst_top", "bubbles", "velocity", _FEW,
           partial=True),
    _stage("remove_bubbles", "bubble_burst", "boiling 3", "bubble_index bubble_count bubble_fate cargo", "", "phase released", _EXACT, partial=True),
    # ---- boiling: vapour
    # a particle that comes into being: all its fields
    _stage("vapour_source", "vapour", "boiling 2.6", "position burst_index burst_top free_index", "vapour boiling step_low step_high first_id served",
           "phase id position velocity mass rest_volume temperature age vapour_support", _FEW, partial=True),
    _stage("vapour_density", "vapour", "boiling 2.6", f"position phase vapour_support {_NEAR}", "vapour", "vapour_density vapour_pressure", _SUM,
           partial=True),
    _stage("vapour_force", "vapour", "boiling (16)",
           f"position phase temperature vapour_density vapour_pressure vapour_support {_NEAR}", "vapour dt", "velocity vapour_push", _STIFF,
           partial=True),
    _stage("vapour_move", "vapour", "boiling 2.6", "velocity", "bubbles vapour dt", "phase position age", _FEW, partial=True),
    _stage("vapour_precision", "vapour", "boiling (16)", f"phase vapour_density vapour_push {_NEAR}", "vapour", "vapour_support", _FEW, partial=True),
    # ---- weakly compressible SPH of Mueller 2003, baseline of boiling's Table 1
    _stage("sph_density", "sph", "boiling 1", f"position phase rest_volume {_NEAR}", "sph", "density pressure constraint", _SUM),
    _stage("sph_force", "sph", "boiling 1", f"position velocity phase rest_volume density pressure {_NEAR}", "sph dt", "velocity_next", _STIFF),
    # ---- surface: line 15
    _stage("surface", "surface", "melting 2.8", f"position phase volume {_NEAR}", "smoothing full_neighbours", "surface", _EXACT),
    _stage("surface_field", "surface_field", "melting 2.8", "position temperature cell_start surface_node", "grid reconstruction",
           "surface_distance surface_temperature", _EIGEN),
]

STAGES = {stage.name: stage for stage in _LIST}
