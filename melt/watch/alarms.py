"""Alarms: speeds and densities that no stable run of the scene reaches. (Values that are not finite: `melt.finite`.)"""

import math

import numpy as np

from melt.diagnostics import compression, measure_of
from melt.errors import Unstable
from melt.physics.phases import INACTIVE, LIQUID
from melt.stages import STAGES

#: ``watch.speed = "auto"`` is this many times `reachable` (25 times the energy).
SPEED_FACTOR = 5


def reachable(scene, initial, settings):
    """Return (speed [m/s], what gives it): the largest of those that the scene itself names.

    A fall through the whole domain, the start, inflows, moving bodies, waves of surface tension and in what is elastic, and
    a tenth of the sound speed, which is laid out for that. Without gravity, that may name no speed, a spacing per step.
    """
    size, gravity = initial.domain_upper - initial.domain_lower, np.abs(scene.domain.gravity)
    reach = float(np.linalg.norm(size))
    found = {
        "a fall through the domain": math.sqrt(2 * float(gravity @ size)),
        "the start": initial.top_speed,
        "an inflow": max((nozzle.speed for nozzle in scene.inflow), default=0.0),
        "a moving body": max((fastest(body, reach) for body in getattr(settings, "bodies", ())), default=0.0),
        "surface tension": math.sqrt(2 * max(scene.fluid.sigma, 0.0) / (scene.fluid.density * scene.spacing)),
        "elasticity": getattr(settings, "elastic_speed", 0.0),
        "a tenth of the sound speed": 0.1 * settings.sound_speed if scene.solver.pressure == "wcsph" else 0.0,
        "a spacing per step": 0.0 if gravity.any() else scene.spacing / scene.time.dt,
    }
    name = max(found, key=found.get)
    return found[name], name


def fastest(body, reach):
    """Return the largest speed [m/s] of a point of a moving body that is at most ``reach`` from its centre."""
    speeds = body.speeds if body.times.size else body.velocity[None]
    return float(np.linalg.norm(speeds, axis=1).max() + np.linalg.norm(body.spin) * reach)


def bounds_of(scene, initial, settings):
    """Return {"speed": [m/s], "density": mean compression}, infinity for what is not watched.

    A flood has solver.top_speed, which its step page holds, and no density. A position based liquid has no automatic bound of
    the speed: its step cuts what moves too far, and what boils by the paper's rules throws its water out faster than any fall.
    """
    if scene.kind == "flood" or not scene.solver.motion:
        return {"speed": math.inf, "density": math.inf}
    w = scene.watch
    speed = w.speed
    if speed == "auto":
        speed = "off" if scene.solver.pressure == "pbf" else SPEED_FACTOR * reachable(scene, initial, settings)[0]
    return {"speed": math.inf if speed == "off" else speed, "density": math.inf if w.density_error == "off" else w.density_error}


def check_speed(sim):
    """Raise `Unstable` if the largest speed of the step exceeds its bound; reads nothing otherwise."""
    clock, bound = sim.do.clock, sim.bounds["speed"]
    if not clock.max_speed > bound:
        return
    speed = np.linalg.norm(sim.state.read("velocity").astype(np.float64), axis=0)
    speed[sim.state.read("phase") == INACTIVE] = 0.0
    given = "watch.speed"
    if sim.scene.watch.speed == "auto":
        given += f" = auto, {SPEED_FACTOR} times {reachable(sim.scene, sim.initial, sim.prepared.settings)[1]}"
    raise Unstable(
        f"{when(clock)}: the largest speed is {clock.max_speed:.3g} m/s, beyond the alarm of {bound:.3g} m/s ({given}).",
        f"Fastest is {particle(sim, int(np.argmax(speed)))}, now with {speed.max():.3g} m/s.",
        remedy=remedy(sim, "watch.speed"),
        speed=bound,
    )


def check_density(sim):
    """Raise `Unstable` if the liquid is compressed more than its bound on average."""
    state, clock, bound = sim.state, sim.do.clock, sim.bounds["density"]
    measure = measure_of(state)
    if not math.isfinite(bound) or measure is None or clock.step == 0:
        return
    liquid = state.read("phase") == LIQUID
    if not liquid.any():
        return
    names = ("density", "mass", "volume") if measure == "density" else (measure,)
    error = compression({name: state.read(name) for name in names}, liquid)
    mean = float(error.mean())
    if mean > bound:
        i = int(np.flatnonzero(liquid)[np.argmax(error)])
        raise Unstable(
            f"{when(clock)}: the liquid is compressed by {mean:.1%} on average, beyond the alarm of {bound:.1%} (watch.density_error).",
            f"Most compressed, by {error.max():.1%}, is {particle(sim, i)}.",
            remedy=remedy(sim, "watch.density_error"),
            stage=[name for name in sim.prepared.stages if measure in STAGES[name].writes][-1],
        )


def when(clock):
    """Return the step and time of a run in words."""
    return f"step {clock.step}, t = {clock.time:.5g} s"


def particle(sim, i, of=""):
    """Return who is in slot ``i``, in words; ``of``: ``apic_`` for APIC particles."""
    x = np.array2string(sim.state.read(of + "position")[:, i], precision=4)
    return f"{of.upper().replace('_', ' ')}particle {int(sim.state.read(of + 'id')[i])}, position {x} m"


def remedy(sim, *bounds):
    """Return what may help a run that is not stable; ``bounds``: keys of those that it exceeded."""
    raised = " or ".join((sim.prepared.steadier, *bounds))
    return f"The frames before are kept. Lower time.dt, fix time.n_sub to more sub-steps, or raise {raised}."
