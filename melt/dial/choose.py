"""A point of a stored front for ``melt run`` and ``melt plan``: by preset, by error, or by time."""

import re
from typing import NamedTuple

from melt import units
from melt.dial.report import percent, place
from melt.errors import MeltError
from melt.forecast import forecast
from melt.geometry.build import build
from melt.plan import prepare
from melt.scene import find_scene, load_scene
from melt.scene.fronts import MEASURED, scene_hash, stored_front


class Choice(NamedTuple):
    """A scene with the overrides of a chosen point, and what to say of it (no lines if nothing was chosen)."""

    scene: object
    lines: list


def choose(name, overrides=(), preset=None, max_error=None, budget=None, until=None, precision=None):
    """Return the `Choice` of a scene: its preset, or the point that ``max_error`` ("2%") or ``budget`` ("60 s") selects.

    ``overrides`` and ``precision`` come after the point's own; ``until``: end of the run [s], the scene's unless given.

    Raises:
        MeltError: no front is stored, none of its points qualifies (the nearest is named), or more than one way is given.
    """
    given = [option for option, value in (("--preset", preset), ("--max-error", max_error), ("--budget", budget)) if value is not None]
    if len(given) > 1:
        raise MeltError(f"{' and '.join(given)} each choose a point: give one of them")
    changed = [option for option, value in (("--set", overrides), ("--precision", precision)) if value]
    if max_error is None and budget is None:
        scene = load_scene(name, overrides, preset)
        front = stored_front(find_scene(name)) if preset in MEASURED and scene.preset != preset else None
        return Choice(scene, said(f"preset {preset}", front, front.preset(preset), name, changed) if front else [])
    front = stored_front(find_scene(name))
    if front is None:
        raise MeltError(f"{given[0]} chooses from a measured front, and none is stored for {name}: run melt tradeoff {name} --store")
    if max_error is not None:
        point, why = by_error(front, share(max_error)), f"--max-error {max_error}"
    else:
        point, why = by_time(front, load_scene(name, overrides), units.duration(budget, "--budget"), until), f"--budget {budget}"
    return Choice(load_scene(name, [*point.overrides, *overrides]), said(why, front, point, name, changed))


def share(text):
    """Return percent from "2%", "2 %" or the share 0.02."""
    found = re.fullmatch(r"\s*([0-9.eE+-]+)\s*(%?)\s*", str(text))
    try:
        value = float(found[1]) * (1 if found[2] else 100)
    except (TypeError, ValueError):
        value = -1.0
    if not 0 < value < float("inf"):
        raise MeltError(f"--max-error {text}: write a share above 0, such as 2% or 0.02")
    if value >= 100 and not found[2]:
        raise MeltError(f"--max-error {text}: without % that is {value:g} %; write {text}%, or a share below 1 such as 0.02")
    return value


def by_error(front, limit):
    """Return the cheapest point whose error and spread together are at most ``limit`` [percent]."""
    ranked = front.usable()
    for point in ranked:
        if point.at_most <= limit:
            return point
    if not ranked:
        raise MeltError("no point of the stored front ran: measure it again with melt tradeoff --store")
    nearest = min(ranked, key=lambda p: p.at_most)
    raise MeltError(
        f"no stored point is within {percent(limit)}: the nearest is {nearest.point!r} with {percent(nearest.error)}, "
        f"spread {percent(nearest.spread)}, at {nearest.s_per_simulated_s:.3g} s per simulated second; nothing was run"
    )


def by_time(front, default, budget, until=None):
    """Return the most accurate point whose forecast wall time fits ``budget`` [s].

    The forecast is that of the scene as it is on two free CPU cores, times the measured ratio of the point's cost.
    """
    if front.default.failure:
        raise MeltError("the scene as it is did not run when its front was measured, so no cost follows from its forecast: use --max-error")
    initial = build(default)
    steps = default.time.steps if until is None else default.time.steps_to(until)
    seconds = forecast(default, initial, prepare(default, initial), steps).seconds
    ranked = [(seconds * p.s_per_simulated_s / front.default.s_per_simulated_s, p) for p in front.usable()]
    fitting = [(p.error, cost, p) for cost, p in ranked if cost <= budget]
    if fitting:
        return min(fitting, key=lambda item: item[:2])[2]
    if not ranked:
        raise MeltError("no point of the stored front ran: measure it again with melt tradeoff --store")
    cost, nearest = ranked[0]
    raise MeltError(
        f"no stored point fits {budget:g} s: the nearest, {nearest.point!r}, takes about {cost:.3g} s on 2 free cores "
        f"(error {percent(nearest.error)}): give more time, or an earlier --until; nothing was run"
    )


def said(why, front, point, name, changed=()):
    """Return the lines that say what was chosen and where on the front it sits; ``changed``: options that alter the point."""
    facts = front.facts
    lines = [
        f"{why}: {place(front, point)}",
        f"  error: {facts.get('error')}; measured over {facts.get('simulated')} on {facts.get('date')} with {facts.get('machine')}: "
        "on another machine ratios carry over, milliseconds do not",
    ]
    if changed:
        lines.append(f"  with {' and '.join(changed)} on top, its error and cost are others")
    if facts.get("scene hash") != scene_hash(find_scene(name)):
        lines.append(f"  the scene has changed since its front was measured: melt tradeoff {name} --store measures it again")
    return lines
