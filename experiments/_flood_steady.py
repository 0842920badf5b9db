"""Steady flow between driven edges: three flows over a bump, MacDonald's channel; and a wave that leaves over an edge."""

import numpy as np

from experiments import _flood_channels as channels
from experiments import _flood_norms as norms
from experiments._flood_fv import Basin
from experiments._flood_runs import columns, scatter, start, to

#: Case -> (scene, preset, discharge [m^2/s], where it is measured [m], width [m]).
CASES = {
    "subcritical": ("steady_bump", None, 4.42, (1.0, 24.0)),
    "transcritical": ("steady_bump", "transcritical", 1.53, (1.0, 24.0)),
    "jump": ("steady_bump", "jump", 0.18, (1.0, 24.0)),
    "macdonald": ("macdonald", None, channels.MACDONALD_Q, (3.0, 97.0)),
}


def solution(case):
    """Return the function of x [m] that gives the exact `Flow`."""
    if case == "macdonald":
        return channels.macdonald_short
    return lambda x: channels.bump_flow(x, case)


def jump_place(case):
    """Return where the water jumps [m], None where it does not."""
    return {"jump": channels.bump_jump(), "macdonald": channels.MACDONALD_JUMP}.get(case)


def steady(case, *settings, end=None, over=0.25, precision="double"):
    """Run a steady flow to its end; figures are means over the last ``over`` of it."""
    name, preset, q, (low, high) = CASES[case]
    sim = start(name, *settings, preset=preset, precision=precision)
    end = end or sim.scene.time.end
    width, spacing = sim.scene.terrain.upper[1] - sim.scene.terrain.lower[1], sim.scene.fluid.spacing
    bins = np.arange(low, high + 1e-9, max(1.0, 2 * spacing))
    x = np.arange(low + 0.5 * spacing, high, spacing)
    y = np.arange(0.5 * spacing, width, spacing)
    profiles, flows, errors, every = [], [], [], [0]

    def keep(sim):
        if sim.time < (1 - over) * end or sim.time < every[0]:
            return
        every[0] = sim.time + over * end / 40
        c = columns(sim)
        there, inside = solution(case)(c.x), (c.x > low) & (c.x < high)
        errors.append(norms.l1_depth(c.depth[inside], there.depth[inside], c.A[inside]))
        flows.append(np.histogram(c.x, bins, weights=c.V * c.u)[0] / np.diff(bins) / width)
        profiles.append(scatter(c, *np.meshgrid(x, y), ((1, 0.0), (1, width)))[0].mean(axis=0))

    run = to(sim, end, keep)
    depth, flow, there = np.mean(profiles, axis=0), np.mean(flows, axis=0), solution(case)(x)
    values = sim.series()
    found = {
        "L1": float(np.mean(errors)), "mean_L1": norms.l1_depth(depth, there.depth),
        "relative": float(np.mean(np.abs(depth / there.depth - 1))),
        "q": float(flow.mean() / q - 1), "q_worst": float(np.abs(flow / q - 1).max()), "volume_error": abs(values["volume_error"]),
        "columns": int(values["liquid_particles"]), "seconds": run.seconds, "sub_steps": run.sub_steps, "spacing": spacing,
        "settings": f"{sim.scene.solver.kernel} {sim.scene.solver.support:g}", "x": x, "depth": depth, "flow": flow, "bins": bins,
    }
    if jump_place(case) is not None:
        found["jump"] = (_jump(case, x, depth, spacing) - jump_place(case)) / spacing
    return found


def _jump(case, x, depth, spacing):
    """Return where the depth rises through the mean of both sides of the exact jump [m]."""
    at = jump_place(case)
    before, after = solution(case)(np.array([at - 1e-6, at + 1e-6])).depth
    near = np.abs(x - at) < max(10 * spacing, 2.0)
    return norms.jump_position(x[near], depth[near], before, after)


def steady_volumes(case, spacing, order=2, end=None):
    """Run the finite-volume bar to the same flow; return its L1 of depth and largest error of q.

    Water comes in by a source over the first 2 m, behind a wall; the stage at the outlet is imposed.
    """
    name, _, q, (low, high) = CASES[case]
    end = end or {"macdonald": 400.0, "jump": 200.0}.get(case, 60.0)
    first, last = (-8.0, 108.0) if case == "macdonald" else (-2.0, 27.0)
    x = np.arange(first + 0.5 * spacing, last, spacing)
    inner = np.clip(x, 0.0, channels.MACDONALD_END) if case == "macdonald" else x
    there = solution(case)(inner)
    outlet = float(there.depth[-1] + there.bed[-1])
    source = np.where(x < first + 2.0, q / 2.0, 0.0)[None]
    basin = Basin(there.bed[None], np.maximum(outlet - there.bed, 0.05)[None], spacing, source=source, order=order,
                  manning=channels.MACDONALD_N if case == "macdonald" else 0.0,
                  edges={"west": "wall", "east": "open" if case == "transcritical" else lambda t: outlet})
    basin.run(end)
    inside = (x > low) & (x < high)
    d = basin.depth[0]
    return {"L1": norms.l1_depth(d[inside], there.depth[inside]), "q": float(np.abs(basin.state[1, 0] / q - 1)[inside].max())}


def leaving_wave(*settings, height=0.2, spacing=0.2, width=4.0, precision="double"):
    """Send a wave 10 m long over a side beyond which there is still water; return what comes back, over its height."""
    sim = start("steady_bump", *[
        "terrain.lower=[0.0, 0.0]", "terrain.upper=[40.0, 2.0]", "terrain.shape=flat", "terrain.parameters={}", "terrain.cell=0.5",
        "fluid.reference_depth=1.0", f"fluid.spacing={spacing}", f"edge=[{{side = 'east', depth = 1.0, far = true, width = {width}}}]",
        f"fluid.fill=[{{profile = 'solitary', parameters = {{height = {height}, depth = 1.0, crest = 25.0, level = 1.0}}}}]",
    ], *settings, precision=precision)
    x, y = np.meshgrid(np.arange(2.0, 36.0, spacing), np.arange(0.5 * spacing, 2.0, spacing))

    def surface():
        depth = scatter(columns(sim), x, y, ((1, 0.0), (1, 2.0), (0, 0.0)))[0].mean(axis=0)
        return np.convolve(depth, np.full(5, 0.2), "valid")  # mean over a metre: the wave passes, scatter of columns does not

    to(sim, 1.0)
    still = float(np.median(surface()))  # sums differ from depths by a few tenths of a per cent
    incident = float(surface().max()) - still
    back = []

    def keep(sim):
        # the wave has left by 8.5 s; what is reflected has not come to the wall at x = 0 by 13 s
        if 8.5 < sim.time < 13.0:
            back.append(surface() - still)

    to(sim, 13.0, keep)
    return {"incident": incident, "reflected": float(np.abs(back).max()) / incident, "noise": float(np.std(back)) / incident,
            "columns": int(sim.series()["liquid_particles"]), "settings": f"{sim.scene.solver.kernel} {sim.scene.solver.support:g}"}
