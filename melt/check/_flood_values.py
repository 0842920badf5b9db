"""Parameters of the flood's check scene, and the variants in which its stages are checked."""

QUANTUM, RATIO, GROWTH, SMALLEST, LARGEST, SIGMA = 2.0**-8, 2.66, 1.125, 0.5, 4.0, 1.004
GRID = dict(origin_x=-1.0, origin_y=-1.0, origin_z=0.0, inverse_cell=1.0, nx=14, ny=18, nz=1)
TERRAIN = dict(origin_x=-0.5, origin_y=-1.0, inverse_dx=0.5, inverse_dy=1.0, nx=9, ny=13, sampler=0)
RINGS = 6
SIZES = dict(terrain_node=TERRAIN["nx"] * TERRAIN["ny"], entry=5, zone=3)

#: Typical magnitudes in the scene; others are those of the main one.
SCALES = dict(
    spacing=0.5, depth=1.0, area=0.25, curvature=0.5, flux=2.0, speed=2.0, volume=0.25, mass=250.0, acceleration=100.0, rate=10.0,
    one=1.0, time=1.0,
)

FLOOD = dict(
    gravity=9.81, kernel=0, sigma=SIGMA, ratio=RATIO, smallest=SMALLEST, largest=LARGEST, growth=GROWTH, iterations=3, tolerance=1e-3,
    form=0, stiffness=10.0, reference_depth=0.75, clamp=0, lax_friedrichs=0.8, viscosity=0.05, wall_mirror=1, shortest_wall=0.3,
    front=0.02,
)
CONTROL = dict(mode=1, slope_on=0.1, slope_full=0.4, spread=0.5, shortest=0.25, longest=1.0, probe=0.5)
BASIN = dict(
    lower_x=0.25, lower_y=0.125, upper_x=12.0, upper_y=17.0, west=0, east=1, south=0, north=0, longest_move=0.0625, guard=1, skin=0.125,
)
FRICTION = dict(law=0, value=0.03, mapped=1, thinnest=0.01, control=1)
SAMPLING = dict(cover=0.5, wet=0.05)

#: Scalars that differ from those of the main scene, or that only a flood has.
SCALARS = {
    "dt": 1 / 64, "rings": RINGS, "empty": 0, "density": 1000.0, "time": 2.5, "rate": 0.5, "thinnest": 0.125, "factor": 0.3,
    "count": SIZES["entry"], "slot": 7, "first_id": 5000,
}

SWITCHES = {
    "flood": {"kernel": (0, 1), "form": (0, 1, 3), "iterations": (0, 1, 3), "wall_mirror": (0, 1), "lax_friedrichs": (0.0, 0.8)},
    "terrain_grid": {"sampler": (0, 1, 2)},
    "control": {"mode": (0, 1, 2), "slope_full": (0.0, 0.4), "longest": (1.0, 100.0)},
    "basin": {"west": (0, 1), "east": (0, 1), "south": (0, 1), "north": (0, 1), "guard": (0, 1)},
    "friction": {"law": (0, 1, 2), "mapped": (0, 1), "control": (0, 1)},
}
EXTRA = {
    "flood_force": [{"form": 3, "clamp": 1}],
    "cell_reach": [{"empty": 1}, {"rings": 2}, {"rings": 1}],
    "flood_neighbours": [{"capacity": 20}],
    "wall_neighbours": [{"wall_capacity": 7}],
}
