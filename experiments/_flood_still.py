"""Water at rest: lakes over five beds from a relaxation start, and one whose depths are exact, in the balanced form."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from experiments._flood_runs import columns, start, to
from melt.flood.bed import bed_at
from melt.flood.lattice import sigma_of
from melt.flood.plan import grid_values
from melt.flood.walls import sort_boundary
from melt.geometry.build import build
from melt.geometry.depth_sums import near, weight
from melt.scene import load_scene
from melt.simulation import Simulation

STAGE = 0.5  # [m]
#: Bed -> settings; 6 m x 4 m, water up to 0.5 m. Shores want equal columns: a lattice of equal areas ends in very thin ones.
BEDS = {
    "kinked bump": ("terrain.shape=bump", "terrain.parameters={height = 0.2, curvature = 0.05, centre = [3.0, 0.0]}"),
    "smooth bump": ("terrain.shape=smooth_bump", "terrain.parameters={height = 0.2, width = 2.0, centre = [3.0, 0.0]}"),
    "random": ("terrain.shape=noise", "terrain.parameters={amplitude = 0.1, wavelength = 2.0, octaves = 3, seed = 4}"),
    "island": ("terrain.shape=cone", "terrain.parameters={centre = [3.0, 2.0], base_diameter = 2.4, height = 0.6, slope = 0.5}",
               "fluid.layout=equal_mass"),
    "shore": ("terrain.shape=beach", "terrain.parameters={slope = 0.1, depth = 0.3, shore = 0.0}", "terrain.lower=[-3.0, 0.0]",
              "terrain.upper=[3.0, 4.0]", "fluid.layout=equal_mass"),
}
STAGES = {"shore": 0.0, "random": 0.4}
EDGE = 0.6  # [m] beside a hard edge without boundary columns nothing is measured


def lake(bed, spacing=0.2, settle=200.0, *settings, seconds=2.0, walls=True, precision="double"):
    """Let a lake come to rest, then run it: fastest column, surface against its mean (rms and largest) over the depth.

    ``walls``: boundary columns that carry the stage; without them the edges are hard, and all forces have a potential.
    """
    stage = STAGES.get(bed, STAGE)
    sim = start("lake_at_rest", *BEDS[bed], f"fluid.fill=[{{stage = {stage}}}]", f"fluid.spacing={spacing}", f"fluid.settle={settle}",
                "output.maps=false", f"boundary.columns={str(walls).lower()}", "time.n_sub_max=100", *settings, precision=precision)
    run = to(sim, seconds)
    c = columns(sim)
    eta, speed = c.depth + c.bed, np.hypot(c.u, c.v)
    (west, south), (east, north) = (sim.initial.terrain.world(b) for b in c.bounds)
    beside = np.minimum.reduce([c.x - west, east - c.x, c.y - south, north - c.y])
    seen = (c.depth > 0.2 * c.depth.max()) & (beside > (0.0 if walls else EDGE))
    mean = (c.A @ eta)[()] / c.A.sum() if walls else float(eta[seen].mean())
    scale = float(c.V @ c.depth / c.V.sum())
    return {
        "speed": float(speed.max()), "speed_rms": float(np.sqrt(np.mean(speed**2))),
        "surface": float(np.abs(eta - mean)[seen].max() / scale), "surface_rms": float(np.sqrt(np.mean((eta - mean)[seen] ** 2)) / scale),
        "settled": float(sim.do.notes.get("settled_speed", np.nan)), "columns": c.V.size, "seconds": run.seconds,
        "settings": f"{sim.scene.solver.kernel} {sim.scene.solver.support:g}, {sim.scene.fluid.layout}", "stage": float(mean - stage),
        "depth": scale,
    }


def exact_lake(bed, spacing=0.1, steps=50, ratio=0.8):
    """Run a lake in the balanced form from volumes whose sums are the depths of a level surface, to rounding.

    Supports are held at their upper limit, ``ratio`` of what the columns would take, so that sums are linear in the
    volumes; where the support follows the volume, a common factor on all volumes would change no sum. The square lattice
    keeps the volumes positive. Returns the largest speed, and the largest deviation of the first surface.
    """
    def scene_of(spacing):
        return load_scene("lake_at_rest", [
            *BEDS[bed], f"fluid.fill=[{{stage = {STAGE}}}]", f"fluid.spacing={spacing}", "fluid.layout=lattice", "fluid.settle=0",
            "fluid.reference_depth=0.5", "output.maps=false", "solver.form=balanced", "solver.support_limits=[0.1, 1.0]",
            "solver.precision=double", "solver.tolerance=1e-15", "solver.iterations=20", "solver.kernel=cubic",
        ])

    initial, scene = build(scene_of(spacing)), scene_of(ratio * spacing)
    sigma = sigma_of(scene)
    x, h = initial["position"][:2], scene.support
    bed_here = bed_at(initial.terrain, *x)
    depth = STAGE - initial.terrain.datum - bed_here
    n = depth.size
    pairs = near(x, x, np.full(n, h))
    matrix = coo_matrix((sigma * weight(pairs.r, h), (pairs.row, pairs.other)), (n, n)).tocsc()
    wall, area = initial["boundary_position"], initial["boundary_area"]
    beside = near(x, wall[:2], np.full(n, h))
    carried = np.maximum(0.0, (depth + bed_here)[beside.row] - wall[2, beside.other])
    walls = np.bincount(beside.row, sigma * area[beside.other] * weight(beside.r, h) * carried, n)
    volume = spsolve(matrix, depth - walls)
    initial.arrays.update(rest_volume=volume, mass=volume * scene.fluid.density, depth=depth, support_radius=np.full(n, h))
    sort_boundary(initial.arrays, grid_values(scene, initial))
    sim = Simulation(scene, "cpu", initial=initial)
    begin = columns(sim)
    eta = begin.depth + begin.bed
    clamped = int(sim.series()["clamped_columns"])
    for _ in range(steps):
        sim.step()
    c = columns(sim)
    return {
        "speed": float(np.hypot(c.u, c.v).max()), "surface": float(np.abs(eta - STAGE).max()), "columns": n, "clamped": clamped,
        "least_volume": float(volume.min() / (spacing**2 * depth.mean())), "most_volume": float(volume.max() / (spacing**2 * depth.mean())),
    }
