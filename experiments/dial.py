"""The accuracy dial: presets of every shipped scene, measured

Costs are of one machine, in a run of the scene as far as the sweep went; ratios carry over to others, milliseconds do not. The
error is the scene's own headline (note), its spread half of the range over seeds. Rules (`melt/dial/front.py`): accurate is the
cheapest point within the spread of the lowest error at up to 4 times default's cost, draft the cheapest with at most 10 % or three times
default's error, balanced the knee between them. Stored in data/fronts; `melt tradeoff --all --store` measures them again.
"""

import h5py

from experiments import Row
from melt.dial.report import percent, ratio
from melt.scene import shipped_scenes
from melt.scene.fronts import MEASURED, as_text, front_of_text, stored_front


def run(out, quick=False, say=print):
    """Keep the stored fronts; nothing is run."""
    with h5py.File(out, "w") as file:
        for name, path in shipped_scenes().items():
            front = stored_front(path)
            if front is not None:
                file[name] = as_text(front)
            say(f"{name}: {'no front is stored' if front is None else front.facts['date']}")


def report(path):
    """Return a row per preset of a scene."""
    with h5py.File(path) as file:
        return [row for name in file for row in _rows(name, front_of_text(file[name].asstr()[()]))]


def _rows(name, front):
    default, facts = front.default, front.facts
    what = f"{facts['error']}; {facts['simulated']}, {facts['date']}, {len(front.points)} points"
    yield Row(f"{name}: default", "", _measured(default), "", None, what)
    for preset in MEASURED:
        point = front.preset(preset)
        if point is not None:
            cost = "" if default.failure else f", {ratio(point, default)} of default's cost"
            how = "; ".join(point.overrides) or "as it is"
            yield Row(f"{name}: {preset}", "", f"{_measured(point)}{cost}", "", None, f"{point.point}: {how}")


def _measured(point):
    if point.failure:
        return point.failure[:100]
    return f"{percent(point.error)} +- {percent(point.spread)} at {point.s_per_simulated_s:.3g} s per simulated second"
