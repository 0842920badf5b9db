"""The one table of arrays: name, extents, kind, unit, natural scale, meaning.

Everything that allocates, files, checks or documents an array reads it from here.
Shapes are written with extents (`EXTENTS`); component axes come first: ``(3, particle)``.

Kinds: ``real`` follows the precision policy, ``position`` is float64 under ``mixed``,
``double`` is always float64 (ledgers), ``int`` is int32. ``scale`` names the entry of `State.scales` that makes a difference in
this field large or small (see `melt.check`); integers compare exactly.
"""

from typing import NamedTuple

from melt import fields_flood, fields_slime

#: Every extent that a shape may name, and what it counts.
EXTENTS = {
    "particle": "particles of all phases, inactive slots included (fixed for a run)",
    "neighbour": "capacity of a particle's neighbour list",
    "cell": "cells of the neighbour grid + 2 (the last range holds inactive particles)",
    "chunk": "pieces of 256 elements in scans over particles or cells: ceil(max(particle, cell) / 256)",
    "node": "nodes of the KD-tree (one per particle)",
    "site": "lattice sites that ever held a solid particle, plus spare ones for freezing",
    "link": "27 voxel offsets of a direct neighbour, itself at 13",
    "region": "(2w+1)^3 offsets of a shape matching region",
    "material": "materials of the scene",
    "heater": "heaters of the scene",
    "nucleus": "spare bodies for nucleation",
    "inlet": "particles of one layer of all nozzles together",
    "surface_node": "points at which the surface field is wanted",
    "table": "points of the kernel table over the support radius",
    "bin": "quarters of a spacing over the height of the domain and as much again",
    "column": "columns of the neighbour grid, nx ny, x fastest",
    "voxel": "cells of the temperature grid, a spacing wide, x fastest",
    "reduction": "64 partial results of a fixed-shape reduction",
    "pixel_row": "rows of the picture",
    "pixel_column": "its columns",
    "half_row": "rows at half resolution: ceil(pixel_row / 2)",
    "half_column": "columns at half resolution",
    "stop": "colours of a map, evenly spaced from 0 to 1",
    "relief_row": "nodes of the drawn height field in y",
    "relief_column": "nodes of the drawn height field in x",
} | fields_flood.EXTENTS | fields_slime.EXTENTS


class Field(NamedTuple):
    name: str
    shape: tuple
    kind: str
    unit: str
    scale: str
    meaning: str


def _f(name, shape, kind, unit, scale, meaning):
    return Field(name, tuple(shape.split()), kind, unit, scale, meaning)


_TABLE = [
    # particles
    _f("id", "particle", "int", "1", "", "permanent number of the particle"),
    _f("phase", "particle", "int", "1", "", "0 liquid, 1 solid, 2 wall, 3 bubble, 4 vapour, 5 inactive, 6 airborne, 7 driven"),
    _f("material", "particle", "int", "1", "", "row of the material table"),
    _f("site", "particle", "int", "1", "", "lattice site of a (once) solid particle, -1 for none"),
    _f("position", "3 particle", "position", "m", "spacing", "position; of a flood, z is the water surface"),
    _f("position_next", "3 particle", "position", "m", "spacing", "position after the pass (double buffer)"),
    _f("velocity", "3 particle", "real", "m/s", "speed", "velocity"),
    _f("velocity_next", "3 particle", "real", "m/s", "speed", "velocity after the pass (double buffer)"),
    _f("force", "3 particle", "real", "N", "force", "force on the particle"),
    _f("mass", "particle", "real", "kg", "mass", "mass"),
    _f("rest_volume", "particle", "real", "m^3", "volume", "undeformed volume V0"),
    _f("volume", "particle", "real", "m^3", "volume", "volume by which the particle enters SPH sums (phi V_min for solids)"),
    _f("density", "particle", "real", "kg/m^3", "density", "SPH density of a liquid, rest density of others"),
    _f("pressure", "particle", "real", "Pa", "pressure", "Tait pressure, 0 for others than liquid"),
    _f("boundary_pressure", "particle", "real", "Pa", "pressure", "pressure of the liquid around a liquid particle, which solids and walls near it carry"),
    _f("offenders", "particle", "int", "1", "", "pairs of the particle that are closer than the guard distance"),
    _f("surface", "particle", "int", "1", "", "1 on the free surface of a liquid or solid"),
    _f("temperature", "particle", "real", "degC", "temperature", "temperature"),
    _f("temperature_next", "particle", "real", "degC", "temperature", "temperature after the pass (double buffer)"),
    _f("conductivity", "particle", "real", "W/(m K)", "conductivity", "k of a particle; K in m^2/s in paper mode"),
    _f("heat_volume", "particle", "real", "m^3", "volume", "volume V_i of the heat exchange"),
    _f("heat_capacity", "particle", "real", "J/K", "heat_capacity", "capacity C_i of a particle; V_i in m^3 in paper mode"),
    _f("latent_energy", "particle", "real", "J", "latent_energy", "latent heat absorbed so far, from 0 (frozen) to latent_capacity"),
    _f("latent_capacity", "particle", "real", "J", "latent_energy", "latent heat of the whole particle (K m^3 in paper mode)"),
    _f("latent_point", "particle", "real", "degC", "temperature", "temperature at which the particle melts or freezes, inf if it does neither"),
    _f("heat_capacity_molten", "particle", "real", "J/K", "heat_capacity", "heat capacity above latent_point (heat_capacity holds below it)"),
    # position based fluid
    _f("position_predicted", "3 particle", "position", "m", "spacing", "predicted position, before anything holds it back"),
    _f("mobility", "particle", "real", "1/kg", "mobility", "inverse mass in the position solve; 0 for what only displaces (walls, solids, bubbles)"),
    _f("constraint", "particle", "real", "1", "one", "density constraint C = rho/rho_0 - 1 of a liquid particle at its last iteration"),
    _f("multiplier", "particle", "real", "kg m^2", "multiplier", "Lagrange multiplier lambda of the density constraint; 0 for others than liquid"),
    _f("correction", "3 particle", "real", "m", "spacing", "position correction of one iteration, relaxed"),
    _f("vorticity", "3 particle", "real", "1/s", "rate", "curl of the velocity"),
    _f("momentum_size", "particle", "real", "kg m/s", "momentum", "m |v| of a liquid particle, 0 for others"),
    _f("effect_precision", "particle", "real", "1", "one", "effect precision F, from 0 to 1"),
    _f("support_radius", "particle", "real", "m", "spacing", "support radius R_i of a liquid particle (of a flood: h_i of a column); 0 for others, which take their partner's"),
    _f("iterations", "particle", "int", "1", "", "iterations J_i of a liquid particle in the next step; 0 for others"),
    _f("iteration_key", "particle", "int", "1", "", "largest J of a liquid particle and its neighbours; 0 for others"),
    _f("active_index", "particle", "int", "1", "", "particles whose key exceeds the iteration, ascending"),
    _f("active_count", "1", "int", "1", "", "number of them"),
    _f("solid_index", "particle", "int", "1", "", "particles of solids, ascending"),
    _f("solid_count", "1", "int", "1", "", "number of them"),
    _f("kernel_scale", "2 table", "real", "1", "one", "315/(64 pi S) and 45/(pi G) over the support radius"),
    _f("height_bins", "bin", "int", "1", "", "liquid particles by height above the floor, in quarters of a spacing"),
    _f("pbf_bounds", "2 reduction", "real", "m/s, 1", "speed", "largest speed and density constraint of liquid particles"),
    # boiling: heat of the liquid
    _f("latent_store", "particle", "real", "J/kg", "latent_heat", "heat that a liquid particle took up at the boiling point"),
    _f("heat_sum", "particle", "real", "1", "one", "(1/6) sum of V_j r^2 lap W3 over liquid neighbours: 1 in the continuum"),
    _f("heater_heat", "reduction", "double", "J", "heat", "heat that the heater brought in this step"),
    _f("lost_heat", "reduction", "double", "J", "heat", "heat that the surface lost in this step"),
    _f("boil_content", "reduction", "double", "J", "heat", "heat of the liquid, m (c_p T + latent store)"),
    _f("voxel_temperature", "voxel", "real", "degC", "temperature", "temperature of the grid (heat_model = grid)"),
    _f("voxel_temperature_next", "voxel", "real", "degC", "temperature", "temperature of the grid after the pass (double buffer)"),
    _f("liquid_sums", "5 reduction", "double", "kg, kg m/s, kg K", "one", "sums over the liquid of m, m v (3) and m T"),
    # boiling: lists of particles
    _f("bubble_index", "particle", "int", "1", "", "slots of the bubbles, by ascending id"),
    _f("bubble_count", "1", "int", "1", "", "number of them"),
    _f("free_index", "particle", "int", "1", "", "inactive slots, ascending"),
    _f("free_count", "1", "int", "1", "", "number of them"),
    _f("candidate", "particle", "int", "1", "", "1 for a liquid particle that boils in this step"),
    _f("birth_index", "particle", "int", "1", "", "slots of the candidates, by ascending id"),
    _f("birth_count", "1", "int", "1", "", "number of them"),
    _f("boiled_sums", "3 reduction", "double", "kg, J, J", "heat", "mass, m (c_p T + latent store) and heat of fusion of the particles that boil"),
    _f("birth_excess", "reduction", "double", "J", "heat", "heat above the latent heat that boiled particles held"),
    _f("list_scratch", "particle", "int", "1", "", "scratch of sorting a list by id"),
    # boiling: bubbles
    _f("bubble_volume", "particle", "double", "m^3", "volume", "volume V0 of a bubble at birth or merger; 0 for others"),
    _f("bubble_radius", "particle", "real", "m", "spacing", "radius of a bubble, 0 for others"),
    _f("birth_height", "particle", "real", "m", "spacing", "height above the floor at which a bubble was born or merged"),
    _f("age", "particle", "real", "s", "time", "time since a bubble or vapour particle was born"),
    _f("cargo", "particle", "int", "1", "", "quarters of a liquid particle that a bubble carries"),
    _f("bubble_push", "3 particle", "real", "kg m^4/s", "bubble_push", "momentum that a bubble hands to the liquid, per sum of kernel weights"),
    _f("bubble_shift", "2 particle", "real", "m", "spacing", "horizontal drift of a bubble towards others"),
    _f("largest_bubble", "reduction", "real", "m", "spacing", "largest radius of the bubbles in each of 64 pieces"),
    _f("bubble_cell", "particle", "int", "1", "", "coarse cell of a bubble; others are in the range behind the last"),
    _f("bubble_order", "particle", "int", "1", "", "particle that comes k-th in the order of coarse cells"),
    _f("bubble_start", "cell", "int", "1", "", "first sorted bubble of a coarse cell"),
    _f("merge_root", "particle", "int", "1", "", "slot of the bubble of smallest id that this one merges with (itself if none), -1 for others"),
    _f("merge_size", "particle", "int", "1", "", "bubbles that merge, at the slot of their root; else 0"),
    _f("merge_removed", "3 reduction", "double", "kg m/s", "one", "momentum that merging took out (merge_velocity = up)"),
    _f("surface_column", "column", "int", "1", "", "height of the highest liquid in a column above the floor, in 1/4096 of a spacing; -1 without liquid"),
    _f("bubble_fate", "particle", "int", "1", "", "0 stays, 1 vanishes, 2 bursts in this step"),
    _f("burst_top", "particle", "real", "m", "spacing", "height of the surface above a bubble that leaves"),
    _f("burst_index", "particle", "int", "1", "", "slots of bursting bubbles, by ascending id"),
    _f("burst_count", "1", "int", "1", "", "number of them"),
    _f("released", "3 reduction", "int", "1", "", "bubbles that vanished, that burst, and the quarters of liquid that they carried"),
    # boiling: vapour
    _f("vapour_density", "particle", "real", "kg/m^3", "one", "SPH density of a vapour particle"),
    _f("vapour_pressure", "particle", "real", "Pa", "one", "pressure of a vapour particle"),
    _f("vapour_push", "particle", "real", "N/m^3", "one", "size of the pressure force on vapour per volume, P_i of eq (16)"),
    _f("vapour_support", "particle", "real", "m", "spacing", "support radius R' of a vapour particle, 0 for others"),
    # heat solvers
    _f("heat_conductance", "particle neighbour", "real", "W/K", "conductance", "G_ij to each neighbour of the list"),
    _f("heat_rate", "reduction", "real", "1/s", "rate", "largest sum of G_ij/C_i of a particle"),
    _f("heat_linear", "particle", "real", "J/K", "heat_capacity", "capacity in the linear system, inf where T is held"),
    _f("heat_excess", "particle", "real", "J", "heat", "enthalpy at the start of the step minus that of the guess"),
    _f("heat_flux", "particle", "real", "J", "heat", "heat received in the step"),
    _f("cg_residual", "particle", "real", "J", "heat", "residual of the heat balance"),
    _f("cg_direction", "particle", "real", "K", "temperature", "search direction"),
    _f("cg_diagonal", "particle", "real", "J/K", "heat_capacity", "diagonal of the system, inf where T is held"),
    _f("cg_product", "particle", "real", "J", "heat", "system matrix times the search direction"),
    _f("cg_sums", "3 reduction", "real", "J K", "one", "partial sums of r.z, p.Ap and the next r.z"),
    _f("heat_content", "2 reduction", "position", "J", "heat", "enthalpy of liquids and solids, and what rounding left out"),
    _f("heat_error", "3 reduction", "real", "K", "temperature", "largest imbalance of a particle, lowest and highest temperature"),
    # neighbour search
    _f("cell", "particle", "int", "1", "", "linear index of the particle's grid cell, x fastest"),
    _f("order", "particle", "int", "1", "", "particle that comes k-th in cell order"),
    _f("cell_start", "cell", "int", "1", "", "first sorted particle of a cell"),
    _f("arrival", "particle", "int", "1", "", "scratch of the sort by cell"),
    _f("chunk_sum", "chunk", "int", "1", "", "scratch of scans"),
    _f("neighbour_count", "particle", "int", "1", "", "number of neighbours; beyond the capacity if the list overflowed"),
    _f("neighbour_index", "particle neighbour", "int", "1", "", "neighbours within the support, ascending, without itself"),
    _f("tree", "node", "int", "1", "", "particle at a node of the left-balanced KD-tree (children 2k+1, 2k+2)"),
    _f("tree_rank", "node", "int", "1", "", "scratch of the KD-tree build"),
    # lattice sites and shape matching regions (region r belongs to site r)
    _f("site_particle", "site", "int", "1", "", "particle at the site, -1 if it has none"),
    _f("site_cell", "3 site", "int", "1", "", "integer lattice coordinates in one global voxel frame"),
    _f("site_rest", "3 site", "real", "m", "spacing", "rest position X0, relative to the body's own origin"),
    _f("site_body", "site", "int", "1", "", "body of the site; spare sites -1"),
    _f("site_component", "site", "int", "1", "", "connected component: its smallest live site; -1 if not live"),
    _f("site_position", "3 site", "position", "m", "spacing", "position of the site's particle, copied into site order"),
    _f("site_velocity", "3 site", "real", "m/s", "speed", "velocity of the site's particle, copied into site order"),
    _f("site_links", "site link", "int", "1", "", "live direct neighbours by offset (arrayN), -1 for none"),
    _f("site_link_count", "site", "int", "1", "", "live direct neighbours incl. itself; 0 if not live; connect + 1 inside"),
    _f("site_melting", "site", "int", "1", "", "1 if the site melts in this step"),
    _f("melted", "reduction", "int", "1", "", "sites that melt in this step, counted in 64 pieces"),
    _f("body_changed", "site", "int", "1", "", "scratch: 1 if a site of body b melts"),
    _f("component_size", "site", "int", "1", "", "live sites of the component whose smallest site this is, else 0"),
    _f("site_dirty", "site", "int", "1", "", "bit 1: region must be refilled; bit 2: its sums must be renewed"),
    _f("site_region", "site region", "int", "1", "", "live sites within w hops by offset (arrayR), -1 for none"),
    _f("site_region_count", "site", "int", "1", "", "members of the region = regions that contain the site"),
    _f("rest_sum", "site", "real", "1/m^3", "number_density", "sum of W over the region at rest, itself included"),
    _f("region_share", "site", "real", "kg", "mass", "mass share of a site in each of its regions, m/n"),
    _f("region_mass", "site", "real", "kg", "mass", "mass of the region"),
    _f("region_rest", "3 site", "real", "m", "spacing", "centre of mass of the region at rest minus the rest position of its own site"),
    _f("region_centre", "3 site", "real", "m", "spacing", "centre of mass of the region minus the position of its own particle"),
    _f("region_mean", "3 site", "real", "m", "spacing", "mean position of the members minus the position of the own particle"),
    _f("region_shift", "3 site", "real", "m", "spacing", "goal of the own particle by its own region alone, minus its position"),
    _f("region_rotation", "4 site", "real", "1", "one", "rotation quaternion (w, x, y, z) of the region, w >= 0"),
    _f("region_velocity", "3 site", "real", "m/s", "speed", "mean velocity of the region"),
    _f("region_spin", "3 site", "real", "1/s", "rate", "angular velocity of the region"),
    _f("goal", "3 site", "real", "m", "spacing", "goal position of the site's particle minus its position"),
    _f("site_adjacent", "site link", "int", "1", "", "sites of the same body by offset, vacant ones included, -1 for none"),
    _f("site_hops", "site", "int", "1", "", "scratch: hops to the nearest site that froze in this step"),
    _f("freeze_site", "particle", "int", "1", "", "vacant site that a freezing particle would take, -1 for none"),
    _f("freeze_shift", "3 particle", "real", "m", "spacing", "predicted position of that site minus the particle's"),
    _f("freeze_distance", "particle", "int", "1", "", "distance to that site in 1/4096 of the reach"),
    _f("frozen", "reduction", "int", "1", "", "sites that were taken in this step, counted in 64 pieces"),
    _f("component_centre", "3 site", "real", "m", "spacing", "centre of mass of the component minus the position of its first particle"),
    _f("component_rest", "3 site", "real", "m", "spacing", "the same at rest; component fields stand at its smallest site"),
    _f("component_rotation", "4 site", "real", "1", "one", "rotation quaternion (w, x, y, z) of the component, w >= 0"),
    _f("component_push", "3 site", "real", "m/s^2", "acceleration", "force on the component / its mass"),
    _f("component_twist", "3 site", "real", "1/s^2", "rate2", "angular acceleration of the component, I^+ torque"),
    _f("claim", "site", "int", "1", "", "freezing particle that won the site, -1 for none"),
    _f("nucleation", "particle", "int", "1", "", "bit 1: cold liquid without a solid near; bit 2: it starts a body"),
    _f("nucleus_sites", "2 nucleus", "int", "1", "", "first site of a spare body, and its last + 1"),
    _f("nucleus_free", "nucleus", "int", "1", "", "scratch: 1 if no site of the spare body is live"),
    _f("nucleus_count", "reduction", "int", "1", "", "scratch: particles that would start a body, in 64 pieces"),
    _f("nucleated", "reduction", "int", "1", "", "particles that started a body in this step, in 64 pieces"),
    # materials (rows of the scene's material table)
    _f("material_density", "material", "real", "kg/m^3", "density", "rest density"),
    _f("material_conductivity", "material", "real", "W/(m K)", "conductivity", "k; K in m^2/s in paper mode"),
    _f("material_specific_heat", "material", "real", "J/(kg K)", "specific_heat", "c; unused in paper mode"),
    _f("material_melting_point", "material", "real", "degC", "temperature", "melting point, inf if it never melts"),
    _f("material_latent_heat", "material", "real", "J/kg", "latent_heat", "latent heat of fusion"),
    _f("material_melts_to", "material", "int", "1", "", "material row after melting"),
    _f("material_freezes_to", "material", "int", "1", "", "material row after freezing, -1 if it never freezes"),
    # heaters
    _f("heater_shape", "heater", "int", "1", "", "0 box (centre, half sizes), 1 sphere (centre, radius in the first)"),
    _f("heater_centre", "3 heater", "real", "m", "spacing", "centre of the heater"),
    _f("heater_size", "3 heater", "real", "m", "spacing", "half sizes of the heater"),
    _f("heater_mode", "heater", "int", "1", "", "0 rate, 1 target temperature (fixes it)"),
    _f("heater_value", "heater", "real", "W/m^3 or degC", "temperature", "rate (K/s in paper mode) or target temperature"),
    _f("heater_reach", "heater", "real", "m", "spacing", "particles this far outside the heater still feel it"),
    # inflow: rows of all nozzles, a nozzle emits its rows as one layer
    _f("inflow_position", "3 inlet", "position", "m", "spacing", "where a particle of the layer enters"),
    _f("inflow_velocity", "3 inlet", "real", "m/s", "speed", "velocity with which it enters"),
    _f("inflow_mass", "inlet", "real", "kg", "mass", "its mass"),
    _f("inflow_volume", "inlet", "real", "m^3", "volume", "its rest volume"),
    _f("inflow_temperature", "inlet", "real", "degC", "temperature", "its temperature"),
    _f("inflow_material", "inlet", "int", "1", "", "its material"),
    # surface reconstruction (output only)
    _f("surface_node", "3 surface_node", "position", "m", "spacing", "point at which the surface field is wanted"),
    _f("surface_distance", "surface_node", "real", "m", "spacing", "surface field, negative inside the liquid"),
    _f("surface_temperature", "surface_node", "real", "degC", "temperature", "temperature at the point, 0 away from particles"),
    # reductions read by the host
    _f("motion_bounds", "2 reduction", "real", "m/s, m/s^2", "speed", "largest speed and acceleration of mobile particles"),
    *[_f(*row) for row in fields_flood.TABLE],
    *[_f(*row) for row in fields_slime.TABLE],
    # screen-space renderer
    _f("screen_radius", "particle", "real", "m", "spacing", "radius with which a particle is drawn; not above 0: it is not"),
    _f("particle_value", "particle", "real", "1", "one", "place of the particle's colour on the map, 0 to 1"),
    _f("screen_sphere", "4 particle", "real", "m", "spacing", "centre in the camera frame (right, down, forward) and radius; 0 if unseen"),
    _f("screen_box", "4 particle", "real", "px", "one", "first and last column, first and last row that a sphere reaches; -1 last if unseen"),
    _f("screen_skipped", "reduction", "int", "1", "", "particles whose position or radius is not finite, in 64 pieces"),
    _f("screen_depth", "pixel_row pixel_column", "real", "m", "spacing", "depth of the liquid's surface, inf for none"),
    _f("screen_depth_next", "pixel_row pixel_column", "real", "m", "spacing", "depth after a pass of smoothing (double buffer)"),
    _f("screen_normal", "3 pixel_row pixel_column", "real", "1", "one", "normal of the surface in the camera frame, towards the eye"),
    _f("screen_length", "half_row half_column", "real", "m", "spacing", "thickness: length of the ray inside liquid"),
    _f("screen_length_next", "half_row half_column", "real", "m", "spacing", "thickness, blurred"),
    _f("screen_length_sum", "half_row half_column", "int", "1", "", "scratch: thickness in fixed point"),
    _f("screen_value", "2 half_row half_column", "real", "1", "one", "sums of weight times particle_value, and of weights, near the surface"),
    _f("screen_value_sum", "2 half_row half_column", "int", "1", "", "scratch: both sums in fixed point"),
    _f("screen_map", "3 stop", "real", "1", "one", "colours (red, green, blue) of the map"),
    _f("behind_depth", "pixel_row pixel_column", "real", "m", "spacing", "depth of what stands behind the liquid (ground, solids), inf for none"),
    _f("behind_colour", "3 pixel_row pixel_column", "real", "1", "one", "its colour (red, green, blue), 0 to 1"),
    _f("picture", "3 pixel_row pixel_column", "real", "1", "one", "colour (red, green, blue), 0 to 1; highlights exceed it"),
    _f("relief_height", "relief_row relief_column", "real", "m", "spacing", "height of the drawn height field, NaN for a hole"),
]

FIELDS = {field.name: field for field in _TABLE}

#: Particle fields that travel when particles are sorted. All else is derived within a step.
CARRIED = (
    "id phase material site position velocity mass rest_volume temperature latent_energy latent_capacity"
    " position_predicted effect_precision support_radius iterations"
    " latent_store bubble_volume bubble_radius birth_height age cargo vapour_support"
).split() + list(fields_flood.CARRIED) + list(fields_slime.CARRIED)

#: Fields that mean something for one phase only: a slot that changes its phase may keep what it had.
_OWNER = {"bubble_radius": 3, "cargo": 3, "latent_store": 0, "constraint": 0, "effect_precision": 0}


def owned(name, values, phase):
    """Return the values (n,) of a field, 0 for particles of a phase that does not have it."""
    if name not in _OWNER:
        return values
    return (values * (phase == _OWNER[name])).astype(values.dtype)
