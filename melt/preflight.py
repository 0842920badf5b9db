"""What can be known before a run: findings with their fixes, limits of the time step, forecast."""

import math
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from melt.boiling_findings import boiling_findings
from melt.constants import lattice_density, lattice_offsets
from melt.finite import check_initial
from melt.flood import findings as flood
from melt.forecast import forecast
from melt.geometry.build import build
from melt.physics.phases import INACTIVE, LIQUID, SOLID, WALL
from melt.plan import prepare
from melt.position_based import bottom_compression, relaxation, stiffness
from melt.scales import explicit_heat_limit
from melt.slime.findings import slime_findings
from melt.stages import STAGES
from melt.systems.steps import over_limit

#: Why a bound is small, and what moves it.
WHY = {
    "sound": ": the sound speed of {0.sound_speed:.3g} m/s keeps compression within fluid.compression; a larger one is faster",
    "viscosity": ": the viscosity; a coarser domain.spacing is faster",
    "light solid": ": a solid far lighter than the liquid",
}

#: Distance of neighbouring float32 numbers in spacings from which positions make a stiff liquid noisy.
FINEST = 2e-6


class Finding(NamedTuple):
    """Something to know before a run, and what to do about it."""

    level: str  # "note" or "warning"
    text: str
    fix: str = ""

    @property
    def advice(self):
        """The finding and its fix."""
        return self.text + (f". Fix: {self.fix}" if self.fix else "")

    def __str__(self):
        return f"{self.level}: {self.advice}"


class Plan(NamedTuple):
    """A scene's plan: what `prepare` recorded, and what was found."""

    scene: object
    initial: object
    prepared: object
    findings: list
    limits: dict  # bound -> seconds

    def lines(self):
        """Return the plan as lines of text."""
        return [
            *_head(self),
            "",
            *_stages(self),
            "",
            *_fields(self),
            "",
            *_forecast(self),
            "",
            *map(str, self.findings),
        ]


def plan(scene, precision=None, initial=None):
    """Return the `Plan` of a scene, refused as a run of it would be (`MeltError`); nothing is compiled or run."""
    initial = initial or build(scene)
    check_initial(initial, precision or scene.solver.precision)
    prepared = prepare(scene, initial, precision)
    moves = scene.kind == "flood" or scene.solver.motion
    return Plan(scene, initial, prepared, findings(scene, initial, prepared), limits(prepared) if moves else {})


def limits(prepared, speed=0.0):
    """Return {bound: seconds} of the mechanical sub-step at the start, with ``speed`` [m/s] the largest."""

    if prepared.system.__name__ == "melt.systems.flood":
        return flood.limits(prepared, speed)

    class Start:  # a binder at t = 0, as far as `step_limits` looks
        settings, need = prepared.settings, prepared.need

        class clock:
            max_speed, max_acceleration = speed, 0.0

    return prepared.system.step_limits(Start)


def findings(scene, initial, prepared):
    """Return the `Finding` list of a scene."""
    if scene.kind == "flood":
        return [Finding(*found) for found in flood.findings(scene, initial, prepared)]
    found = [Finding("note", note) for note in initial.notes]
    found += [Finding("warning", text) for text in prepared.warnings]
    liquid = _position_based if prepared.need.pbf else _density
    for check in (_overlap, _walls, liquid, _resolution, _sub_steps, _heat, _boiling):
        found += check(scene, initial, prepared)
    if scene.incompressible:
        found += [Finding(*f) for f in slime_findings(scene, prepared)]
    return found


def _overlap(scene, initial, prepared):
    x = initial["position"][:, initial["phase"] != INACTIVE].T
    if len(x) < 2:
        return []
    close = cKDTree(x).query_pairs(0.9 * scene.spacing * (1 - 1e-6), output_type="ndarray")
    if not len(close):
        return []
    at = np.array2string(x[close[0, 0]], precision=3)
    return [
        Finding(
            "warning",
            f"{len(close)} pairs of particles are closer than 0.9 spacings, the first at {at} m: they are thrown apart",
            "move the bodies by whole spacings",
        )
    ]


def _walls(scene, initial, prepared):
    thick = scene.domain.walls.layers * scene.spacing
    if not (initial["phase"] == WALL).any() or thick >= scene.support * (1 - 1e-9):
        return []
    need = math.ceil(scene.support / scene.spacing - 1e-9)
    return [
        Finding(
            "warning",
            f"walls are {thick:g} m thick, thinner than the support of {scene.support:g} m: liquid near them is too light",
            f"domain.walls.layers = {need}",
        )
    ]


def _density(scene, initial, prepared):
    """Compression of the liquid as it is placed, from up to 2000 particles."""
    from melt.reference._pairs import W

    liquid = np.flatnonzero(initial["phase"] == LIQUID)
    if not liquid.size:
        return []
    active = initial["phase"] != INACTIVE
    x = initial["position"][:, active].T
    solid = (initial["phase"] == SOLID)[active]
    weight = np.where(solid, scene.solver.solid_scale, 1.0) * initial["rest_volume"][active]
    some = initial["position"].T[liquid[:: max(1, liquid.size // 2000)]]
    near = cKDTree(some).sparse_distance_matrix(cKDTree(x), scene.support, output_type="coo_matrix")
    smoothing, fluid = prepared.params["smoothing"], prepared.params["fluid"]
    ratio = np.bincount(near.row, weight[near.col] * W(near.data, smoothing), minlength=len(some)) * float(
        fluid.density_factor
    )
    worst = float(ratio.max()) - 1
    text = f"density of the liquid as placed: at most {worst:+.2%} from its rest density, {ratio.max():.4f} of it"
    if worst > max(0.01, 2 * scene.fluid.compression):
        return [Finding("warning", text, "solver.calibrate_mass = true, or liquid regions that do not overlap")]
    return [Finding("note", text)]


def _position_based(scene, initial, prepared):
    """What the lattice says about stability and stiffness of the position based solve."""
    s, pbf = prepared.settings, scene.solver.pbf
    dt = scene.time.dt / (s.n_sub or max(1, math.ceil(scene.time.dt / s.longest_step * (1 - 1e-9))))
    product = relaxation(scene) * stiffness(scene.solver.support).largest
    text = (
        f"position based fluid: predicted compression at the bottom {bottom_compression(scene, s.layers, dt):.2%} with "
        f"sub-steps of {dt:.3g} s; omega' Lmax = {product:.2f} of 2"
    )
    found = [
        Finding("note", text),
        Finding("note", "position based fluid: placed on a lattice it settles in the first tenths of a second, by about 5 % of its height"),
    ]
    if product > 1.5:
        found.append(
            Finding("warning", f"omega' Lmax = {product:.2f}: the solve converges slowly or not at all above 1.5", "solver.pbf.eps_rel")
        )
    if pbf.iterations == 1:
        found.append(Finding("warning", "one iteration per sub-step makes flows gain energy", "solver.pbf.iterations = 4"))
    if pbf.push < 0.02:
        found.append(Finding("warning", f"with an artificial pressure of {pbf.push:g} flows gain energy", "solver.pbf.push = 0.03"))
    return found


def _resolution(scene, initial, prepared):
    if prepared.precision != "single":
        return []
    far = float(np.abs(initial["position"]).max(initial=0.0))
    step = np.spacing(np.float32(far)) / scene.spacing
    if step < (FINEST if scene.solver.pressure == "wcsph" else 1e-3):  # positions have no stiff pressure
        return []
    return [
        Finding(
            "warning",
            f"float32 positions at {far:.3g} m are {step:.1e} spacings apart: the liquid becomes noisy",
            "solver.precision = 'mixed', or coordinates near the origin",
        )
    ]


def _sub_steps(scene, initial, prepared):
    if not scene.solver.motion or prepared.settings.n_sub is None:  # too many automatic ones are refused
        return []
    # the jets of an inflow are not there yet, but will be
    speed = max([initial.top_speed, *(nozzle.speed for nozzle in scene.inflow)])
    text, fix = over_limit(prepared.settings, scene.time.dt, limits(prepared, speed))
    return [Finding("warning", text, fix)] if text else []


def _heat(scene, initial, prepared):
    if scene.heat is None:
        points = [s for s in scene.solid if "melting_point" in s.model_fields_set and math.isfinite(s.melting_point)]
        if not points:
            return []
        text = f"solid {points[0].name!r} has a melting point, but without a [heat] section nothing warms or melts"
        return [Finding("warning", text, "add [heat] to the scene")]
    from melt.systems.heat import chosen_solver

    fo, limit = prepared.settings.fourier_number, explicit_heat_limit(scene, prepared.settings)
    solver = chosen_solver(prepared.settings)
    found = [Finding("note", f"heat: Fourier number {fo:.3g}, solver {solver}, explicit limit {limit:.3g} s")]
    scale = scene.heat.conductivity_scale
    if scene.heat.law == "physical" and scale != 1:
        found.append(Finding("note", f"heat: conducts {scale:g} times as fast as its materials do (heat.conductivity_scale)"))
    if fo > 0.5 and solver.startswith("pairs"):
        found.append(
            Finding(
                "warning",
                f"pair sweeps at a Fourier number of {fo:.3g} depend on the order of pairs",
                "heat.solver = 'cg' or 'auto'",
            )
        )
    return found


def _boiling(scene, initial, prepared):
    if scene.boiling is None:
        return []
    return [Finding(*found) for found in boiling_findings(scene, initial)]


def _head(p):
    scene, counts = p.scene, p.initial.counts
    s = p.prepared.settings
    yield f"scene {scene.scene.name}: {scene.scene.description}"
    if scene.scene.figure:
        yield f"stands for: {scene.scene.figure}"
    yield "particles: " + (", ".join(f"{n:,} {name}" for name, n in counts.items() if n) or "none")
    if scene.kind == "flood":
        yield from flood.head(scene, p.initial, p.prepared)
        return
    inside, density = lattice_offsets(scene.solver.support, scene.domain.dimensions).size, lattice_density(scene)
    lattice = f"{inside} neighbours inside, lattice density {density:.4f}"
    yield f"spacing {scene.spacing:g} m, support {scene.support:g} m ({lattice}), precision {p.prepared.precision}"
    yield f"requires: {p.prepared.required}"
    if scene.solver.motion:
        sound = "" if p.prepared.need.pbf or p.prepared.need.incompressible else f"sound speed {s.sound_speed:.4g} m/s; "
        yield f"{sound}outer step {scene.time.dt:g} s to t = {scene.time.end:g} s"


def _stages(p):
    yield f"stages ({len(p.prepared.stages)}), in order of first call"
    for name in p.prepared.stages:
        yield f"  {name:<22}{STAGES[name].equation}"


def _fields(p):
    from melt.fields import FIELDS

    total = p.prepared.nbytes
    yield f"fields ({len(p.prepared.fields)}), {total / 1e6:.1f} MB, {total / max(1, p.initial['id'].size):.0f} bytes per particle"
    for name in p.prepared.fields:
        field = FIELDS[name]
        yield f"  {name:<26}{' x '.join(field.shape):<26} {field.unit:<12} {p.prepared.bytes(name) / 1e6:>9.3f} MB"


def _forecast(p):
    scene, n = p.scene, p.initial["id"].size
    expected = forecast(scene, p.initial, p.prepared)
    if p.limits:
        governing = min(p.limits, key=p.limits.get)
        for name, seconds in sorted(p.limits.items(), key=lambda item: item[1]):
            yield f"time step bound {name:<12}{seconds:.4g} s{'   <- governs' if name == governing else ''}"
        yield f"sub-steps per outer step at the start: {expected.sub_steps}"
        if p.prepared.settings.n_sub is None:
            why = WHY.get(governing, "").format(p.prepared.settings, dt=scene.time.dt)
            yield f"  {scene.time.dt:g} s / {p.limits[governing]:.3g} s{why}"
    frame = sum(
        8 if f == "id" else 4 * (3 if f in ("position", "velocity") else 1)
        for f in ("id", "position", "velocity", "pressure")
    )
    written = n if scene.output.walls else n - p.initial.counts.get("wall", 0)
    files = (scene.time.steps // scene.time.output_steps + 1) * written * frame
    yield f"forecast on CPU: {expected.text}; {scene.time.steps:,} steps, {files / 1e6:,.0f} MB of output at most"
