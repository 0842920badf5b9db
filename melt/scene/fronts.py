"""Stored fronts: what ``melt tradeoff SCENE --store`` measured, as a table beside the scene, and the presets chosen from it.

Of a shipped scene it is ``data/fronts/NAME.csv``, of others ``NAME.front.csv`` beside the scene file. A comment line per fact
(``# date: ...``), then one row per point: costs, error and spread in percent, whether it is on the front, and its preset.
"""

import csv
import hashlib
import io
import json
import math
import pathlib
import tomllib
from typing import NamedTuple

from melt.errors import MeltError, SceneError
from melt.output.errors import OutputError
from melt.output.whole import write_whole

PACKAGE = pathlib.Path(__file__).resolve().parents[1]

#: Presets that are points of a measured front.
MEASURED = ("draft", "balanced", "accurate")
COLUMNS = (
    "point", "overrides", "ms_per_step", "s_per_simulated_s", "bytes", "error_percent", "spread_percent", "on_front", "preset", "failure",
)


class FrontPoint(NamedTuple):
    """One measured point. NaN where it failed, or where one repetition tells no spread."""

    point: str
    overrides: tuple
    ms_per_step: float
    s_per_simulated_s: float
    bytes: int
    error: float  # percent
    spread: float  # percent, half of the range over seeds
    on_front: bool = False
    presets: tuple = ()
    failure: str = ""

    @property
    def at_most(self):
        """Error and spread together [percent]."""
        return self.error + (self.spread if math.isfinite(self.spread) else 0.0)


class Front(NamedTuple):
    """The measured points of a scene and the facts of the measurement."""

    facts: dict
    points: list

    @property
    def default(self):
        """The scene as it is."""
        return self.points[0]

    def preset(self, name):
        """Return the point of a preset, None without."""
        return next((p for p in self.points if name in p.presets), None)

    def usable(self):
        """Return the points that ran, cheapest first."""
        return sorted((p for p in self.points if not p.failure and math.isfinite(p.error)), key=lambda p: p.s_per_simulated_s)


def front_path(scene_path):
    """Return where the front of the scene file at ``scene_path`` is stored."""
    path = pathlib.Path(scene_path)
    folders = [place / "data" for place in (PACKAGE, PACKAGE.parent)]  # installed, or a source tree
    data = next((folder for folder in folders if path.resolve().parent == folder / "scenes"), None)
    return data / "fronts" / f"{path.stem}.csv" if data else path.with_suffix(".front.csv")


def scene_hash(scene_path):
    """Return a short hash of what a scene file says: comments, its name and its presets do not count."""
    data = tomllib.loads(pathlib.Path(scene_path).read_text(encoding="utf-8"))
    about = {k: v for k, v in data.pop("scene", {}).items() if k == "exact"}
    data.pop("presets", None)
    text = json.dumps([about, data], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def stored_front(scene_path):
    """Return the stored `Front` of a scene file, None if there is none.

    Raises:
        SceneError: the file there is no front.
    """
    path = front_path(scene_path)
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError(f"front {path} cannot be read: {error}") from None
    try:
        return front_of_text(text)
    except (KeyError, ValueError, IndexError, TypeError, AttributeError, csv.Error) as error:  # a row cut short has None
        raise SceneError(f"front {path} is damaged ({error}): measure it again with melt tradeoff --store") from None


def front_of_text(text):
    """Return the `Front` that `as_text` wrote."""
    facts, rows = {}, []
    for line in text.splitlines():
        if line.startswith("# "):
            name, _, value = line[2:].partition(": ")
            facts[name] = value
        else:
            rows.append(line)
    points = []
    for row in csv.DictReader(rows):
        numbers = (float(row[name] or "nan") for name in ("ms_per_step", "s_per_simulated_s"))
        overrides = tuple(text for text in row["overrides"].split("; ") if text)
        points.append(FrontPoint(
            row["point"], overrides, *numbers, int(row["bytes"] or 0), float(row["error_percent"] or "nan"),
            float(row["spread_percent"] or "nan"), row["on_front"] == "yes", tuple(row["preset"].split()),
            row["failure"],
        ))
    points[0]  # a front has its default
    return Front(facts, points)


def as_text(front):
    """Return the file of a front."""
    def number(value):
        return f"{value:.4g}" if math.isfinite(value) else ""

    out = io.StringIO()
    for name, value in front.facts.items():
        out.write(f"# {name}: {' '.join(str(value).split())}\n")
    table = csv.writer(out, lineterminator="\n")
    table.writerow(COLUMNS)
    for p in front.points:
        table.writerow([
            p.point, "; ".join(p.overrides), number(p.ms_per_step), number(p.s_per_simulated_s), p.bytes or "", number(p.error),
            number(p.spread), "yes" if p.on_front else "", " ".join(p.presets), " ".join(p.failure.split())[:160],
        ])
    return out.getvalue()


def storable(scene_path):
    """Return where the front of a scene file is stored.

    Raises:
        MeltError: that is inside of an installed melt, which is nobody's to write to, and is gone with the next version.
    """
    path = front_path(scene_path)
    if PACKAGE in path.resolve().parents:
        raise MeltError(
            f"{pathlib.Path(scene_path).stem} is a scene of the installed melt, where no front is stored: copy {scene_path} to a folder "
            "of yours and measure that file"
        )
    return path


def store(front, scene_path):
    """Write the front of a scene; return where. An older one is replaced whole or not at all.

    Raises:
        MeltError: it cannot be written.
    """
    path = storable(scene_path)
    try:
        path.parent.mkdir(exist_ok=True)
        write_whole(path, as_text(front).encode())
    except (OSError, OutputError) as error:
        why = (error.__cause__ or error).strerror
        raise MeltError(f"the front cannot be stored as {path} ({why}): copy the scene to a folder of yours") from None
    return path


def measured_preset(scene_path, name, called):
    """Return the overrides of a measured preset of a scene file that the user ``called`` so.

    Raises:
        SceneError: no front is stored, or it has no such preset.
    """
    front = stored_front(scene_path)
    if front is None:
        raise SceneError(
            f"preset {name!r} is a point of a measured front, and none is stored for {called}: run melt tradeoff {called} --store"
        )
    point = front.preset(name)
    if point is None:
        raise SceneError(f"the front {front_path(scene_path)} has no point {name!r}: measure it again with melt tradeoff --store")
    return list(point.overrides)
