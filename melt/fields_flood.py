"""Arrays of the shallow water flood: rows of the table of `melt.fields`. Flood spec 0."""

EXTENTS = {
    "boundary": "boundary particles of walls and obstacles of a flood, sorted by cell",
    "wall_neighbour": "capacity of a column's list of boundary particles",
    "terrain_node": "nodes of the terrain, south-west first, x fastest",
    "sample": "points at which the flood is sampled: the nodes of the map, then the gauges",
    "entry": "columns that enter in a step",
    "zone": "open boundaries with a given stage or discharge",
}

TABLE = [
    # columns of water
    ("position_before", "3 particle", "position", "m", "spacing", "position before the last move (control force)"),
    ("depth", "particle", "real", "m", "depth", "depth of the water column; of an airborne one, of the water under it"),
    ("support_factor", "particle", "real", "1", "one", "Omega = alpha/(2 d) of the variable support, 1 where it is clamped"),
    ("depth_state", "particle", "int", "1", "", "bits: 1 h at its largest, 2 at its smallest, 4 not solved, 8 fewer than 3 neighbours"),
    ("bed", "particle", "real", "m", "depth", "bed elevation b under the column"),
    ("bed_slope", "2 particle", "real", "1", "one", "gradient of b, the exact derivative of what `bed` samples"),
    ("bed_curvature", "3 particle", "real", "1/m", "curvature", "second derivatives of b: xx, yy, xy"),
    ("acceleration", "2 particle", "real", "m/s^2", "acceleration", "acceleration of the column along x and y"),
    ("brake", "particle", "real", "m/s^2", "acceleration", "braking by the terrain velocity control force (< 0 speeds up)"),
    ("cell_support", "cell", "real", "m", "spacing", "largest support radius of the columns in the cell, 0 without any"),
    ("cell_reach", "cell", "int", "1", "", "rings of cells around this one that may hold neighbours of its columns"),
    ("wall_count", "particle", "int", "1", "", "boundary particles near the column"),
    ("wall_index", "particle wall_neighbour", "int", "1", "", "their numbers, ascending"),
    ("flood_bounds", "6 reduction", "real", "1/s, 1/s^2, 1/s, m/s, m, 1", "rate",
     "largest (sqrt(g d) + |v|)/l, |a|/l, |v|/min(l, terrain cell), |v|, h, and a count of columns with clamped h"),
    # walls and obstacles
    ("boundary_position", "3 boundary", "position", "m", "spacing", "place of a boundary particle; z is the bed there"),
    ("boundary_area", "boundary", "real", "m^2", "area", "V_b, the area that a boundary particle stands for"),
    ("boundary_start", "cell", "int", "1", "", "first boundary particle of each cell"),
    ("boundary_ring", "cell", "int", "1", "", "rings of cells to the nearest cell with a boundary particle"),
    # terrain
    ("terrain", "terrain_node", "real", "m", "depth", "bed elevation above the lowest node"),
    ("terrain_wall", "terrain_node", "real", "m", "spacing", "signed distance to what water may not enter, < 0 inside; large without any"),
    ("terrain_friction", "terrain_node", "real", "s/m^(1/3)", "one", "friction coefficient of the node's cell (length 0: one value for all)"),
    # columns that enter
    ("entry_position", "3 entry", "position", "m", "spacing", "where a column enters"),
    ("entry_velocity", "3 entry", "real", "m/s", "speed", "velocity with which it enters"),
    ("entry_volume", "entry", "real", "m^3", "volume", "its volume"),
    ("entry_clearance", "entry", "real", "m", "spacing", "distance from there to the nearest column, at most the largest support"),
    ("left_volume", "4 reduction", "double", "m^3", "volume", "volume that left in this sub-step: open edges, blocked ground, infiltration, too thin"),
    # open boundaries with a given stage or discharge
    ("zone_box", "4 zone", "position", "m", "spacing", "x from, x to, y from, y to of the strip whose columns are driven"),
    ("zone_probe", "4 zone", "position", "m", "spacing", "the same of the strip beside it, where the water is measured"),
    ("zone_normal", "2 zone", "real", "1", "one", "unit vector from the edge into the water"),
    ("zone_sums", "3 zone", "double", "m^2, m^4/s, m^3", "one", "sums over the probe of area A, V v . n and V"),
    ("zone_speed", "zone", "real", "m/s", "speed", "v . n that the columns of the zone take"),
    # maps and gauges
    ("sample_position", "2 sample", "position", "m", "spacing", "point of a map or gauge"),
    ("sample_bed", "sample", "real", "m", "depth", "bed elevation there"),
    ("sample_surface", "sample", "real", "m", "depth", "surface elevation there: mean of eta_j weighted with A_j W_j; the bed where dry"),
    ("sample_depth", "sample", "real", "m", "depth", "that surface above the bed, 0 where dry"),
    ("sample_column", "sample", "real", "m", "depth", "sum of V_j W_j: its integral over a map is the volume of the water"),
    ("sample_speed", "sample", "real", "m/s", "speed", "mean of |v_j|, weighted likewise"),
    ("most_depth", "sample", "real", "m", "depth", "largest sample_depth so far"),
    ("most_speed", "sample", "real", "m/s", "speed", "largest sample_speed so far"),
    ("most_flux", "sample", "real", "m^2/s", "flux", "largest depth times speed so far"),
    ("arrival_time", "sample", "real", "s", "time", "time at which the water came, -1 where it did not"),
    ("wet_time", "sample", "real", "s", "time", "time for which the point was wet"),
]

#: Fields of `TABLE` that travel with their column.
CARRIED = ("position_before", "depth", "brake")
