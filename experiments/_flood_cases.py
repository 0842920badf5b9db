"""Cases of `experiments.flood_analytic` that move: dam breaks, bowls, a circular dam. Each returns a dictionary of figures."""

import math

import numpy as np

from experiments import _flood_exact as exact
from experiments import _flood_norms as norms
from experiments._flood_fv import Basin
from experiments._flood_radial import radial_dam
from experiments._flood_runs import columns, scatter, start, to

THIN = 1e-3  # [m] below this depth a grid point has no velocity
DAMS = {"ritter": (11.0, 0.0), "stoker": (10.0, 0.1)}  # end of the strip [m], depth on the right [m]
BREAK = 1.5  # [s]


def _dam_solution(name):
    h0 = DAMS[name][1]
    return lambda x: exact.stoker(x, BREAK, 1.0, h0) if h0 else exact.ritter(x, BREAK, 1.0)


def dam(name, spacing=0.1, *settings, width=2.0, precision="double"):
    """Run Ritter's or Stoker's dam break in a strip to t = 1.5 s, and measure it at columns and on a grid of the spacing."""
    end, h0 = DAMS[name]
    sim = start(name, f"fluid.spacing={spacing}", f"terrain.upper=[{end}, {width}]", *_pools(h0, width), "output.maps=false",
                "time.n_sub_max=100", *settings, precision=precision)
    run = to(sim, BREAK)
    c, solution = columns(sim), _dam_solution(name)
    there = solution(c.x)
    x = np.arange(-10 + 0.5 * spacing, end, spacing)
    y = np.arange(0.5 * spacing, width, spacing)
    grid = np.meshgrid(x, y)
    sides = [(1, 0.0), (1, width), (0, -10.0)] + ([(0, end)] if h0 else [])
    depth, flux = scatter(c, *grid, sides)
    on_grid = solution(grid[0])
    speed = np.where(depth > THIN, flux[0] / np.maximum(depth, THIN), 0.0)
    found = {
        "L1": norms.l1_depth(c.depth, there.depth, c.A), "L1_velocity": norms.velocity_error(c.u, there.velocity, c.V),
        "grid_L1": norms.l1_depth(depth, on_grid.depth), "grid_L1_velocity": norms.velocity_error(speed, on_grid.velocity, on_grid.depth),
        "across": float(np.abs(c.v).max()), "front": float(c.x.max()), "columns": c.V.size, **_cost(sim, run),
    }
    if h0:
        bore = exact.bore(1.0, h0)
        place = norms.shock_position(x, depth.mean(axis=0), bore.depth, h0)
        found["shock"] = (place - bore.shock * BREAK) / spacing
    return found


def _pools(h0, width):
    pools = [f"{{lower = [-10.0, 0.0], upper = [0.0, {width}], depth = 1.0}}"]
    pools += [f"{{lower = [0.0, 0.0], upper = [10.0, {width}], depth = {h0}}}"] * (h0 > 0)
    return [f"fluid.fill=[{', '.join(pools)}]"]


def _cost(sim, run):
    values = sim.series()
    return {"seconds": run.seconds, "sub_steps": run.sub_steps, "volume_error": abs(values["volume_error"]),
            "clamped": int(values["clamped_columns"]), "settings": f"{sim.scene.solver.kernel} {sim.scene.solver.support:g}"}


def dam_volumes(name, spacing=0.1, order=1):
    """Run the finite-volume bar on cells of the spacing; return its L1 of depth and of velocity."""
    end, h0 = DAMS[name]
    x = np.arange(-10 + 0.5 * spacing, end, spacing)
    basin = Basin(np.zeros((1, x.size)), np.where(x < 0, 1.0, h0)[None], spacing, order=order)
    basin.run(BREAK)
    there = _dam_solution(name)(x)
    u = np.where(basin.depth[0] > THIN, basin.velocity[0, 0], 0.0)
    return {"L1": norms.l1_depth(basin.depth[0], there.depth), "L1_velocity": norms.velocity_error(u, there.velocity, there.depth)}


def _channel_bowl():
    return ("terrain.parameters={radius = 1.0, depth = 0.5, dimension = 1}", "terrain.lower=[-2.0, 0.0]", "terrain.upper=[2.0, 0.4]",
            "terrain.cell=0.02", "fluid.reference_depth=0.25", "boundary.columns=true", "time.dt=0.01",
            "fluid.fill=[{profile = 'thacker_channel', parameters = {a = 1.0, h0 = 0.5, amplitude = 0.5}}]")


def _middle(c):
    return float(c.V @ c.x / c.V.sum())


def _spread(c):
    return float(c.V @ (c.x**2 + c.y**2) / c.V.sum())


def _radial_spread():
    """Mean r^2 is a^2/3 (1 - A cos omega t)/sqrt(1 - A^2): its amplitude [m^2] for a shoreline of 0.8 m."""
    A = (1 - 0.8**4) / (1 + 0.8**4)
    return A / (3 * math.sqrt(1 - A * A))


#: Kind -> (settings, solution (x, y, t), period [s], amplitude of what is fitted, what is fitted).
BOWLS = {
    "planar": ((), exact.thacker_planar, exact.bowl_period(0.1, 1.0), 0.5, _middle),
    "radial": (("fluid.fill=[{profile = 'thacker_radial', parameters = {a = 1.0, h0 = 0.1, shoreline = 0.8}}]",), exact.thacker_radial,
               exact.bowl_period(0.1, 1.0, radial=True), _radial_spread(), _spread),
    "channel": (_channel_bowl(), lambda x, y, t: exact.thacker_1d(x, t), exact.bowl_period(0.5, 1.0), 0.5, _middle),
}


def bowl(kind, spacing=0.025, periods=3, *settings, precision="double"):
    """Run a bowl of Thacker's over some periods; fit the motion of the whole, and measure the depths at the end."""
    given, solution, period, amplitude, figure = BOWLS[kind]
    sim = start("parabolic_bowl", *given, f"fluid.spacing={spacing}", "output.maps=false", "time.n_sub_max=100", *settings,
                precision=precision)
    t, y, energy = [], [], []

    def keep(sim):
        c = columns(sim)
        t.append(sim.time)
        y.append(figure(c))
        values = sim.series()
        energy.append(values["kinetic_energy"] + values["potential_energy"])

    keep(sim)
    run = to(sim, periods * period, keep)
    c = columns(sim)
    there = solution(c.x, c.y, sim.time)
    low, high = sim.scene.terrain.lower, sim.scene.terrain.upper
    grid = np.meshgrid(*(np.arange(a + 0.5 * spacing, b, spacing) for a, b in zip(low, high)))
    walls = [(1, low[1]), (1, high[1])] if kind == "channel" else []
    on_grid = norms.l1_depth(scatter(c, *grid, walls)[0], solution(*grid, sim.time).depth)
    size, T, _, _ = norms.fit_oscillation(t, y, period)
    late = np.array(t) > (periods - 1) * period
    last = norms.fit_oscillation(np.array(t)[late], np.array(y)[late], period)[0] if periods > 1 else size
    return {
        "L1": norms.l1_depth(c.depth, there.depth, c.A), "grid_L1": on_grid, "period": T / period - 1, "amplitude": size / amplitude - 1,
        "last_amplitude": last / amplitude - 1, "energy": energy[-1] / energy[1] - 1, "columns": c.V.size, **_cost(sim, run),
    }


def bowl_volumes(kind, spacing=0.04, periods=3, order=2):
    """Run the finite-volume bar in the same bowl; return its L1 of depth."""
    given, solution, period, *_ = BOWLS[kind]
    x = np.arange(-2 + 0.5 * spacing, 2, spacing)
    X, Y = np.meshgrid(x, [0.0] if kind == "channel" else x)
    first = solution(X, Y, 0.0)
    velocity = np.moveaxis(first.velocity, -1, 0) if first.velocity.ndim > X.ndim else np.stack([first.velocity, 0 * X])
    basin = Basin(first.bed, first.depth, spacing, velocity=velocity, order=order)
    basin.run(periods * period)
    return {"L1": norms.l1_depth(basin.depth, solution(X, Y, basin.time).depth)}


def circle(spacing=0.1, *settings, precision="double"):
    """Run the circular dam; depths on rings, against the run along the radius."""
    sim = start("circular_dam", f"fluid.spacing={spacing}", "output.maps=false", *settings, precision=precision)
    run = to(sim, 0.7)
    c = columns(sim)
    r = np.hypot(c.x, c.y)
    there = radial_dam(r, 0.7, 1.0, 0.2, 2.0)
    x = np.arange(-4 + 0.5 * spacing, 4, spacing)
    grid = np.meshgrid(x, x)
    depth = scatter(c, *grid)[0]
    radius = np.hypot(*grid)
    edges = np.arange(2 * spacing, 4.0, 2 * spacing)
    rings = norms.ring_symmetry(grid[0].ravel(), grid[1].ravel(), depth.ravel(), edges)
    outward = (c.u * c.x + c.v * c.y) / np.maximum(r, 1e-9)
    inside = radius < 4
    return {
        "L1": norms.l1_depth(c.depth, there.depth, c.A), "L1_velocity": norms.velocity_error(outward, there.velocity, c.V),
        "grid_L1": norms.l1_depth(depth[inside], radial_dam(radius[inside], 0.7, 1.0, 0.2, 2.0).depth),
        "ring": float(np.nanmean(rings)), "worst_ring": float(np.nanmax(rings)), "columns": c.V.size, **_cost(sim, run),
    }
