"""Flood scene -> what runs: needs, settings, parameter tuples, extents. Flood spec 2-4."""

import math
from types import SimpleNamespace

import numpy as np

from melt import params as P
from melt import params_flood as F
from melt.flood.lattice import sigma_of

KERNELS = {"cubic": P.CUBIC, "wendland2": P.WENDLAND2}
FORMS = {
    "variational": F.FORM_VARIATIONAL, "symmetric": F.FORM_SYMMETRIC, "balanced": F.FORM_WELL_BALANCED, "linear": F.FORM_LINEAR,
}
SAMPLERS = {"bspline": F.SAMPLER_BSPLINE, "bilinear": F.SAMPLER_BILINEAR, "bicubic": F.SAMPLER_BICUBIC}
MODES = {"paper": F.CONTROL_PAPER, "descent": F.CONTROL_DESCENT, "bead": F.CONTROL_BEAD}
LAWS = {"manning": F.FRICTION_MANNING, "chezy": F.FRICTION_CHEZY, "darcy": F.FRICTION_DARCY}
CELLS_PER_COLUMN = 8  # of the neighbour grid at most, over a terrain that is mostly dry


def needs(scene, initial):
    """Return what the scene requires, as booleans that the step page asks for."""
    sides = [getattr(scene.boundary, side) for side in ("west", "east", "south", "north")]
    blocked = bool((initial["terrain_wall"] < 1e29).any())
    return SimpleNamespace(
        incompressible=False,
        walls=initial["boundary_area"].size > 0,
        balanced=scene.solver.form == "balanced",
        constrained=scene.solver.bed == "constrained",
        control=scene.control is not None,
        drag=scene.friction is not None or scene.control is not None,
        airborne=scene.fluid.release_height > 0,
        entry=bool(scene.inflow or scene.edge or scene.rain),
        zones=bool(scene.edge),
        outlets="open" in sides or bool(scene.edge) or blocked,
        infiltration=scene.infiltration is not None and scene.infiltration.rate > 0,
        samples=initial["sample_bed"].size > 0,
        maps=scene.output.maps,
        guard=blocked,
        # asked for by what all systems share
        pbf=False, sph=False, boiling=False, solids=False, heat=False,
    )


def settings_of(scene, initial, real):
    """Return the run-time choices of the step page."""
    t, s = scene.time, scene.solver
    depth = initial["depth"]
    wave = math.sqrt(scene.gravity * float(depth.max(initial=0.0)))
    return SimpleNamespace(
        n_sub=None if t.n_sub == "auto" else t.n_sub,
        n_sub_max=t.n_sub_max,
        cfl=s.cfl,
        first_kick=s.first_kick,
        top_speed=s.top_speed,
        growth=s.growth,
        support=scene.support,
        start_support=(widest := float(initial["support_radius"][: initial.active].max(initial=scene.support))),
        least_reach=widest if scene.fluid.release_height > 0 else scene.support,  # of columns that enter or land
        largest_support=s.support_limits[1] * scene.support,
        inverse_cell=float(grid_values(scene, initial)["inverse_cell"]),
        start_wave=wave,
        start_length=0.5 * float(initial["support_radius"][: initial.active].min(initial=scene.support)),
        settle=scene.fluid.settle,
        settle_time=1.0 * math.sqrt(scene.fluid.reference_depth / 1.0),
        settle_speed=1e-5 * max(wave, 1e-3),
        density=scene.fluid.density,
        capacity=initial["id"].size,
        infiltration=0.0 if scene.infiltration is None else scene.infiltration.rate,
        thinnest=0.05 * float(initial["rest_volume"][: initial.active].min(initial=scene.column_volume)),
        least_seepage=1e-4 * scene.fluid.reference_depth,
        gauge_every=scene.output.gauge_every,
        fall=math.sqrt(2 * scene.fluid.release_height / scene.gravity),
        gauges=[gauge.name for gauge in scene.gauge],
        nodes=initial.map_nodes,
        sources=initial.sources,
        real=real,
        datum=initial.terrain.datum,
        column_volume=scene.column_volume,
        support_limits=s.support_limits,
        # water that runs onto open ground leaves, what gets stuck in walls is lost
        blocked_ledger="left_edge" if initial.terrain.open.any() else "left_blocked",
    )


def grid_values(scene, initial):
    """Return the values of the `Grid` tuple: one layer of cells over the terrain.

    A cell is as wide as the median support at the start: wider ones hold columns that are no neighbours, narrower ones
    make more rows of cells to visit.
    """
    lower, upper = initial.domain_lower, initial.domain_upper
    supports = initial["support_radius"][: initial.active]
    edge = scene.solver.growth * float(np.median(supports)) if supports.size else scene.support
    edge = max(edge, 0.5 * scene.solver.support_limits[0] * scene.support)
    extent = [b - a + 2 * edge for a, b in zip(lower[:2], upper[:2])]
    most = max(4096, CELLS_PER_COLUMN * initial["id"].size)
    while math.prod(math.ceil(e / edge) for e in extent) > most:
        edge *= 1.26
    nx, ny = (math.ceil(e / edge) for e in extent)
    return dict(
        origin_x=lower[0] - edge, origin_y=lower[1] - edge, origin_z=0.0, inverse_cell=1 / edge, nx=nx, ny=ny, nz=1,
    )


def params_of(scene, initial, real):
    """Return {registry name: tuple} for every stage of the scene."""
    s, dx, terrain = scene.solver, scene.spacing, initial.terrain
    limits = [factor * scene.support for factor in s.support_limits]
    mirror = scene.boundary.law == "mirror"
    flood = P.make(
        P.Flood,
        real,
        gravity=scene.gravity,
        kernel=KERNELS[s.kernel],
        sigma=sigma_of(scene),
        ratio=s.support,
        smallest=limits[0],
        largest=limits[1],
        growth=s.growth,
        iterations=s.iterations,
        tolerance=s.tolerance or (1e-10 if real is np.float64 else 1e-6),
        form=FORMS[s.form],
        stiffness=s.stiffness,
        reference_depth=scene.fluid.reference_depth,
        clamp=int(s.clamp),
        lax_friedrichs=s.alpha,
        viscosity=s.viscosity,
        wall_mirror=int(mirror),
        shortest_wall=0.3,
        front=0.02,
    )
    friction = scene.friction
    ny, nx = terrain.elevation.shape
    found = {
        "grid": P.make(P.Grid, real, **grid_values(scene, initial)),
        "flood": flood,
        "terrain_grid": P.make(
            P.Terrain, real, origin_x=terrain.lower[0], origin_y=terrain.lower[1], inverse_dx=1 / terrain.cell[0],
            inverse_dy=1 / terrain.cell[1], nx=nx, ny=ny, sampler=SAMPLERS[scene.terrain.sampler],
        ),
        "basin": basin_of(scene, initial, real),
        "friction": P.make(
            P.Friction, real, law=LAWS[friction.law] if friction else 0, value=friction.coefficient if friction else 0.0,
            mapped=int("terrain_friction" in initial), thinnest=1e-3, control=int(scene.control is not None),
        ),
        "sampling": P.make(P.Sampling, real, cover=0.5, wet=scene.output.wet_depth),
    }
    if scene.control is not None:
        found["control"] = control_of(scene, dx, terrain.cell, real)
    return found


def control_of(scene, dx, cell, real):
    """Return the `Control` tuple."""
    c = scene.control
    half = 0.5 * min(cell)
    limits = dict(shortest=half, longest=max(half, 2 * dx)) if c.clamp else dict(shortest=0.0, longest=1e30)
    return P.make(P.Control, real, mode=MODES[c.mode], slope_on=c.slope_on, slope_full=c.slope_full, spread=c.spread, probe=half, **limits)


def basin_of(scene, initial, real):
    """Return the `Basin` tuple; a driven side is open."""
    lower, upper = initial.domain_lower, initial.domain_upper
    driven = {edge.side for edge in scene.edge}
    sides = {
        side: F.SIDE_OPEN if side in driven or getattr(scene.boundary, side) == "open" else F.SIDE_WALL
        for side in ("west", "east", "south", "north")
    }
    cell = min(initial.terrain.cell)
    return P.make(
        P.Basin, real, lower_x=lower[0], lower_y=lower[1], upper_x=upper[0], upper_y=upper[1], **sides,
        longest_move=max(0.5 * cell, 0.5 * scene.spacing), guard=int((initial["terrain_wall"] < 1e29).any()), skin=1e-3 * scene.spacing,
    )


def sizes_of(scene, initial, params):
    """Return the size of every extent of a flood."""
    grid = params["grid"]
    cells = int(grid.nx) * int(grid.ny) * int(grid.nz) + 2
    n = initial["id"].size
    inside = math.pi * (scene.solver.growth * scene.solver.support) ** 2
    return {
        "particle": n,
        "neighbour": scene.solver.max_neighbours or 16 * math.ceil(1.5 * inside / 16),
        "wall_neighbour": 16 * math.ceil(0.5 * inside / scene.boundary.spacing**2 / 16),
        "cell": cells,
        "chunk": math.ceil(max(n, cells) / 256) + 1,
        "boundary": initial["boundary_area"].size,
        "terrain_node": initial["terrain"].size,
        "sample": initial["sample_bed"].size,
        "entry": initial.entry_rows,
        "zone": len(scene.edge),
        "reduction": 64,
    }


def absent_of(need, initial):
    """Return the fields that serve scenes with and without something, and that this one is without."""
    absent = set()
    if not need.walls:
        absent |= {"wall_count", "wall_index", "boundary_position", "boundary_area", "boundary_start", "boundary_ring"}
    if not need.control:
        absent |= {"position_before", "brake"}
    if "terrain_friction" not in initial:
        absent |= {"terrain_friction"}
    if not need.guard:
        absent |= {"terrain_wall"}
    return absent
