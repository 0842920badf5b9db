"""What can be known of a flood before it runs: its volume, its terrain, its resolution, its cost. Flood spec 2, 7."""

import math

import numpy as np

from melt.flood.limits import limits_of
from melt.physics.phases import INACTIVE

#: Seconds of a column and sub-step, and of a stage's launch, measured on two cores in single precision.
COLUMN, LAUNCH = 0.17e-6, 50e-6
STEEP = 0.5


def findings(scene, initial, prepared):
    """Return [(level, text, fix)]."""
    found = [("note", note, "") for note in initial.notes]
    found += _volume(scene, initial)
    found += _numbers(scene, initial)
    found += _terrain(scene, initial)
    found += _resolution(scene, initial, prepared)
    found += _courant(scene, prepared)
    found += _inflows(scene, initial)
    return found


def _volume(scene, initial):
    """Water at the start and what flows in, in columns."""
    active = initial["phase"] != INACTIVE
    start = float(initial["rest_volume"][active].sum())
    brought = initial.sources.expected_volume(scene.time.end) if initial.sources else 0.0
    room = int((~active).sum()) * scene.column_volume
    text = f"water: {start:.6g} m^3 at the start"
    if brought:
        text += f", {brought:.6g} m^3 flow in until t = {scene.time.end:g} s, {brought / scene.column_volume:,.0f} columns"
    found = [("note", text, "")]
    if brought > room * 1.001:
        need = math.ceil((brought + start) / scene.column_volume * 1.1)
        found.append(("warning", f"there is room for {room:.6g} m^3 of what flows in: the inflow will stop", f"fluid.capacity = {need}"))
    if not start and not brought:
        found.append(("warning", "there is no water: the run shows a dry terrain", "[[fluid.fill]], [[inflow]], [[edge]] or [rain]"))
    return found


def _numbers(scene, initial):
    """Values that are probably in another unit, and water that is too coarse to mean something."""
    found, dx = [], scene.spacing
    if scene.rain is not None and initial.sources:
        rain = initial.sources.emitters["rain"]
        most, depth = float(rain.rate.values.max()), rain.rate.integral(0.0, scene.time.end)
        if most > 0.5 / 3600:
            found.append(("warning", f"rain of {most * 3600:.3g} m an hour: a number without a unit is in m/s", "rain.rate = \"60 mm/h\""))
        if 0 < depth < scene.column_volume / (2 * dx) ** 2:
            area = scene.column_volume / depth
            text = f"{depth * 1e3:.3g} mm of rain are one column in {area:.3g} m^2: lumps far apart, no sheet of water"
            found.append(("warning", text, "a smaller fluid.spacing or fluid.reference_depth, or no rain"))
    friction = scene.friction
    if friction is not None and friction.law == "manning" and friction.manning > 0.3:
        text = f"a Manning coefficient of {friction.manning:g} s/m^(1/3) all but stops the water (natural ground has 0.02 to 0.15)"
        found.append(("warning", text, f"friction.manning = {1 / friction.manning:.3g}, if the number was Strickler's"))
    if 0 < initial.active < 100:
        found.append(("warning", f"{initial.active} columns are too few for a flow", "a smaller fluid.spacing"))
    return found


def _terrain(scene, initial):
    terrain = initial.terrain
    slope = np.hypot(*np.gradient(terrain.elevation, terrain.cell[1], terrain.cell[0]))
    share = float((slope[~terrain.blocked] > STEEP).mean())
    if share > 0.001 and scene.control is None and scene.solver.bed == "gradient":
        return [
            (
                "warning",
                f"{share:.1%} of the terrain is steeper than {STEEP:g}, where the shallow water equations make water too fast",
                "add [control], or solver.bed = 'constrained'",
            )
        ]
    return []


def _resolution(scene, initial, prepared):
    cell, found = min(initial.terrain.cell), []
    if scene.support < cell / 4:
        text = f"supports of {scene.support:.3g} m are far below the terrain's cells of {cell:.3g} m: columns see a smooth bed"
        found.append(("warning", text, "a larger fluid.spacing is as good"))
    far = float(np.abs(initial["position"]).max(initial=0.0))
    step = float(np.spacing(np.float32(far))) / scene.spacing
    if prepared.precision == "single" and step > 1e-3:
        found.append(("warning", f"float32 positions at {far:.3g} m are {step:.1e} spacings apart", "solver.precision = 'mixed'"))
    return found


def _courant(scene, prepared):
    s = prepared.settings
    if not s.n_sub:
        longest = min(limits(prepared).values())
        n = math.ceil(scene.time.dt / longest * (1 - 1e-9))
        if n <= s.n_sub_max:
            return []
        text = f"{n} sub-steps of {longest:.3g} s in an outer step, but time.n_sub_max is {s.n_sub_max}: the run will stop"
        return [("warning", text, f"time.n_sub_max = {4 * n}, or a shorter time.dt")]
    number = s.cfl * scene.time.dt / s.n_sub / limits(prepared)["wave"]
    text = f"sub-steps of {scene.time.dt / s.n_sub:.3g} s make a Courant number of {number:.2g} in the water at the start"
    if number <= 0.7:
        return [("note", text, "")]
    return [("warning", f"{text}, above 0.7: they are cut", f"time.n_sub = {math.ceil(s.n_sub * number / 0.7)}, or 'auto'")]


def _inflows(scene, initial):
    """Places on which an outer step puts more water at once than can flow off: three times the critical depth."""
    found = []
    for inflow in scene.inflow:
        if inflow.radius is not None:
            area, rim = math.pi * inflow.radius**2, 2 * math.pi * inflow.radius
        else:
            x, y = np.array(inflow.polygon or inflow.line).T
            rim = float(np.hypot(np.diff(x, append=x[0]), np.diff(y, append=y[0])).sum())
            area = float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2 if inflow.polygon else rim * scene.spacing
        most = float(initial.sources.emitters[f"inflow {inflow.name}"].discharge.values.max())
        critical = ((most / rim) ** 2 / scene.gravity) ** (1 / 3)
        at_once = most * scene.time.dt / area
        if at_once > 3 * critical:
            text = f"inflow {inflow.name!r}: an outer step puts {at_once:.3g} m of water there at once; {critical:.3g} m can flow off"
            found.append(("warning", text, f"time.dt = {area * critical / most:.2g}, or a larger place"))
    return found


def limits(prepared, speed=0.0):
    """Return {bound: seconds} of the sub-step at the start."""
    s = prepared.settings
    return limits_of(s.cfl, (s.start_wave + speed) / s.start_length, 0.0, speed / s.start_length)


def head(scene, initial, prepared):
    """Yield the lines that say what a flood is made of."""
    terrain = initial.terrain
    ny, nx = terrain.shape
    cells = f"cells of {terrain.cell[0]:.6g} x {terrain.cell[1]:.6g} m"
    yield f"terrain {terrain.name}: {nx} x {ny} nodes, {cells}, lowest {terrain.datum:.6g} m"
    yield (
        f"columns of {scene.column_volume:.6g} m^3, {scene.spacing:g} m apart in water {scene.fluid.reference_depth:g} m deep; support "
        f"{scene.support:.4g} m there, {s_range(prepared)}; precision {prepared.precision}"
    )
    wanted = [k for k, v in vars(prepared.need).items() if v]
    yield f"requires: {', '.join(wanted) or 'water only'}"
    yield f"outer step {scene.time.dt:g} s to t = {scene.time.end:g} s"


def s_range(prepared):
    """Return the limits of the support in words."""
    flood = prepared.params["flood"]
    return f"between {float(flood.smallest):.4g} and {float(flood.largest):.4g} m"


def seconds_per_step(scene, initial, prepared):
    """Return (sub-steps of an outer step, seconds of it) on two CPU cores."""
    s = prepared.settings
    n_sub = s.n_sub or max(1, math.ceil(scene.time.dt / min(limits(prepared).values()) * (1 - 1e-9)))
    slower = {"single": 1.0, "mixed": 1.3, "double": 1.8}[prepared.precision]
    waiting = 0.5 * float((initial["phase"] == INACTIVE).sum())
    columns = initial.active + waiting
    return n_sub, n_sub * (LAUNCH * len(prepared.stages) + slower * COLUMN * columns)
