"""Registry entries of the shallow water flood, in pipeline order (see `melt.stages`). "En" is an equation of the flood spec."""

from melt.registry import EXACT, FEW, NEAR, SHARE, STIFF, SUM, stage

WALLS = "wall_count wall_index"
_MAP = "sample_surface sample_depth sample_column sample_speed"

LIST = [
    # ---- flood: columns that enter
    stage("entry_clearance", "flood_entry", "flood E17", "entry_position position phase cell_start", "grid flood", "entry_clearance", FEW),
    # a column that comes into being: all its fields
    stage("enter", "flood_entry", "flood E17", "entry_position entry_velocity entry_volume", "flood count slot density first_id",
          "phase id position velocity mass rest_volume support_radius position_before depth brake", FEW, partial=True),
    # ---- flood: neighbours of columns with supports of their own
    stage("cell_support", "flood_cells", "flood 1.5", "phase support_radius cell_start", "", "cell_support", EXACT),
    stage("cell_reach", "flood_cells", "flood 1.5", "cell_support cell_start", "grid flood rings empty", "cell_reach", EXACT),
    stage("flood_neighbours", "flood_neighbours", "flood 1 (neighbour rule)", "position phase support_radius cell_start cell_reach", "grid flood",
          NEAR, EXACT),
    stage("wall_neighbours", "flood_neighbours", "flood E14", "position phase support_radius boundary_position boundary_start boundary_ring",
          "grid flood", WALLS, EXACT),
    # ---- flood: bed, depth
    stage("bed", "flood_bed", "flood E5", "position phase terrain", "terrain_grid", "bed bed_slope", FEW),
    stage("bed_curvature", "flood_bed", "flood E5", "position phase terrain", "terrain_grid", "bed_curvature", FEW),
    # the coupled solve of depth and support takes walls with it
    stage("flood_depth", "flood_depth", "flood E3, E8, E9, E14",
          f"position phase rest_volume bed {NEAR} {WALLS} boundary_position boundary_area support_radius", "flood",
          "support_radius depth support_factor depth_state", SUM),
    stage("flood_surface", "flood_depth", "flood E4", "phase bed depth", "", "position", FEW, partial=True),
    # ---- flood: forces
    stage("control_brake", "flood_control", "flood E11-E13", "position position_before phase support_radius terrain", "terrain_grid control flood", "brake",
          SHARE),
    # both partners' state, and the slope under the column
    stage("flood_force", "flood_force", "flood E6, E7, E10",
          f"id position velocity phase rest_volume depth support_radius support_factor bed_slope {NEAR}", "flood", "acceleration", STIFF),
    # as flood_force, with the bed of both partners and walls in its closure
    stage("balanced_force", "flood_balanced", "flood E6 (wb)",
          f"id position velocity phase rest_volume depth support_radius bed {NEAR} {WALLS} boundary_position boundary_area terrain",
          "flood terrain_grid", "acceleration", STIFF),
    stage("wall_force", "flood_force", "flood E16",
          f"position phase support_radius depth bed support_factor {WALLS} boundary_position boundary_area acceleration", "flood", "acceleration",
          STIFF, partial=True),
    stage("constrain_to_bed", "flood_constrain", "flood E6 (constrained)", "phase velocity bed_slope bed_curvature acceleration", "flood",
          "acceleration", STIFF, partial=True),
    # ---- flood: motion
    stage("flood_bounds", "flood_bounds", "flood E20", "phase velocity acceleration depth support_radius depth_state", "flood terrain_grid", "flood_bounds", FEW),
    stage("flood_kick", "flood_motion", "flood 1.3", "phase acceleration velocity", "flood dt", "velocity", FEW, partial=True),
    stage("flood_drag", "flood_drag", "flood E15, E12b", "position phase depth brake terrain_friction velocity", "flood terrain_grid friction dt", "velocity",
          STIFF, partial=True),
    stage("flood_drift", "flood_motion", "flood 1.3", "phase velocity position", "basin dt", "position position_before", FEW, partial=True),
    stage("flood_guard", "flood_guard", "flood 1.4", "rest_volume terrain_wall phase position velocity", "basin terrain_grid",
          "phase position velocity left_volume", STIFF, partial=True),
    stage("flood_land", "flood_motion", "flood 4 (Fig 10)", "bed depth phase position velocity", "", "phase velocity", FEW, partial=True),
    stage("infiltrate", "flood_sources", "flood E19", "depth phase mass rest_volume", "rate thinnest dt", "phase mass rest_volume left_volume", FEW,
          partial=True),
    stage("damp_columns", "flood_motion", "flood E6 (relaxation start)", "phase velocity", "factor", "velocity", FEW, partial=True),
    # ---- flood: open boundaries
    stage("zone_sums", "flood_zones", "flood E18", "position velocity phase rest_volume depth zone_probe zone_normal", "", "zone_sums", SUM),
    stage("zone_drive", "flood_zones", "flood E18", "position phase zone_box zone_normal zone_speed velocity", "", "velocity", FEW, partial=True),
    # ---- flood: maps and gauges
    stage("flood_sample", "flood_sample", "flood 9",
          "sample_position sample_bed position velocity phase rest_volume depth bed support_radius cell_start cell_reach", "grid flood sampling", _MAP, SHARE),
    stage("keep_most", "flood_sample", "flood 9", "sample_depth sample_speed most_depth most_speed most_flux arrival_time wet_time", "sampling time dt",
          "most_depth most_speed most_flux arrival_time wet_time", FEW, partial=True),
]
