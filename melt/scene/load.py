"""Find, read, override and validate scenes."""

import copy
import difflib
import os
import pathlib
import tomllib

from pydantic import ValidationError

from melt.errors import SceneError
from melt.paths import is_file
from melt.scene.flood import FloodScene
from melt.scene.fronts import MEASURED, measured_preset
from melt.scene.messages import explain
from melt.scene.model import Scene
from melt.scene.presets import BOILING_PRESETS, FLOOD_PRESETS, KETTLE_PRESETS, OPTIONAL_SECTIONS, PRESETS, SLIME_PRESETS
from melt.scene.solver import SYSTEM_OF


def data_folder():
    """Return the folder of shipped scenes and meshes (installed package or source tree)."""
    package = pathlib.Path(__file__).resolve().parent.parent
    for folder in (package / "data", package.parent / "data"):
        if (folder / "scenes").is_dir():
            return folder
    raise SceneError(f"the shipped scenes are missing beside {package}: install melt again")


def shipped_scenes():
    """Return {name: path} of the shipped scenes, sorted by name."""
    return {path.stem: path for path in sorted((data_folder() / "scenes").glob("*.toml"))}


def find_scene(name):
    """Return the path of a scene given by name or by path.

    Raises:
        SceneError: no such scene; close matches are named.
    """
    path = pathlib.Path(name)
    if is_file(path):
        return path
    shipped = shipped_scenes()
    if str(name) in shipped:
        return shipped[str(name)]
    if path.suffix == ".toml":
        raise SceneError(
            f"scene file {str(name)!r} does not exist: check the path; melt scenes lists shipped ones"
        )
    close = difflib.get_close_matches(path.stem, shipped, 3, 0.5)
    hint = f"did you mean {', '.join(close)}?" if close else f"shipped scenes: {', '.join(shipped)}"
    raise SceneError(f"unknown scene {str(name)!r}; {hint} (a scene of your own is a path to a .toml file)")


def load_scene(name, overrides=(), preset=None):
    """Return the validated `Scene` called ``name`` (shipped) or at that path.

    ``overrides`` are texts such as ``heat.conductivity=50``; ``preset`` replaces the scene's own choice, but draft, balanced
    and accurate, points of its measured front, turn knobs of the scene as it is (one of the scene's own goes first).

    Raises:
        SceneError: not found, not TOML, or not a valid scene.
    """
    path = find_scene(name)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError(f"scene {path}: cannot be read ({error}); a scene is a TOML text file") from None
    if preset in MEASURED and preset not in _toml(text, f"scene {path.stem}").get("presets", {}):
        overrides, preset = [*measured_preset(path, preset, name), *overrides], None
    return scene_from_toml(text, f"scene {path.stem}", overrides, preset, path.parent)


def scene_from_toml(text, title="scene", overrides=(), preset=None, folder=None):
    """Return the validated `Scene` of a TOML text, as `load_scene`; mesh files may stand in ``folder``."""
    return scene_from_dict(_toml(text, title), title, overrides, preset, folder)


def _toml(text, title):
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        advice = "text needs quotes, tables need [brackets]"
        raise SceneError(f"{title}: not valid TOML: {error}; {advice}") from None


def scene_from_dict(data, title="scene", overrides=(), preset=None, folder=None):
    """Return the validated `Scene` of nested dictionaries, as `load_scene`."""
    data = copy.deepcopy(data)
    own = data.pop("presets", {})
    if not isinstance(own, dict) or not all(isinstance(values, dict) for values in own.values()):
        raise SceneError(f"{title}: presets must be tables of values by key, such as [presets.coarse]")
    chosen = preset or data.get("preset", "default")
    if not isinstance(chosen, str):
        raise SceneError(f"{title}: preset = {chosen!r} is not allowed: it must be the name of one preset")
    known = {**PRESETS, **own}
    if chosen not in known:
        if chosen in MEASURED:
            raise SceneError(f"{title}: preset {chosen!r} is a point of its measured front, which no scene names: give --preset {chosen}")
        close = difflib.get_close_matches(str(chosen), [*known, *MEASURED], 1)
        hint = f"did you mean {close[0]}? " if close else ""
        measured = f"and {', '.join(MEASURED)} where a front is stored (melt tradeoff)"
        raise SceneError(f"{title}: unknown preset {chosen!r}; {hint}known: {', '.join(known)}, {measured}")
    data["preset"] = chosen
    for key, value in own.get(chosen, {}).items():
        _assign(data, key, value)
    for text in overrides:
        key, _, value = text.partition("=")
        if not _ or not key.strip():
            raise SceneError(f"override {text!r}: write KEY=VALUE, for instance heat.conductivity=50")
        _assign(data, key.strip(), _parse(value.strip()))
    model = FloodScene if "terrain" in data else Scene
    if model is FloodScene:
        _no_heat_in_floods(data, title)
    _fill_in(data, _presets_of(data).get(chosen, {}))
    _resolve_meshes(data, folder)
    if "terrain" in data:
        _resolve_files(data, [folder] if folder else [])
    heat = data.get("heat")
    law = heat.get("law", "paper") if isinstance(heat, dict) else "paper"
    try:
        return model.model_validate(data, context={"law": law})
    except ValidationError as error:
        raise SceneError(explain(error, data, title, model)) from None


def _no_heat_in_floods(data, title):
    """Refuse warm and viscous floods with the reason: their equations have no temperature."""
    asked = [f"[{name}]" for name in ("heat", "boiling", "viscosity", "solid") if name in data]
    if asked:
        raise SceneError(
            f"{title}: a flood ([terrain]) has no {', '.join(asked)}: the shallow-water equations carry a depth and a horizontal velocity "
            "per column, no temperature and no profile over the depth that a warm or stiff liquid needs; friction at the bed stands for "
            "viscosity. For lava or melt-water use a liquid in a box: leave [terrain] out, give the ground as [[obstacle]]"
        )


def _presets_of(data):
    """Return the presets of the system that a scene belongs to (`Scene.system`, of data that are not yet validated)."""
    if "terrain" in data:
        return FLOOD_PRESETS
    solver = data.get("solver")
    pressure = solver.get("pressure") if isinstance(solver, dict) else None
    system = SYSTEM_OF.get(str(pressure), "melting")
    if system == "boiling":
        return KETTLE_PRESETS if "heat" in data else BOILING_PRESETS
    return SLIME_PRESETS if system == "slime" else PRESETS


def _parse(text):
    """Return a TOML value; what is no TOML is text (so that quotes may be left out)."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _assign(data, key, value):
    """Set the value at a dotted key; ``none`` removes it. List items go by number, ``*`` is all of them."""
    *path, last = key.split(".")
    targets = [data]
    for part in path:
        targets = [inner for target in targets for inner in _step(target, part, key)]
    for target in targets:
        if not isinstance(target, dict):
            raise SceneError(f"override {key}: {key.rpartition('.')[0]} has no keys")
        if value == "none" and last not in ("baseline",):
            target.pop(last, None)
        else:
            target[last] = value


def _step(target, part, key):
    if isinstance(target, list):
        if part == "*":
            return target
        if part.isdigit() and int(part) < len(target):
            return [target[int(part)]]
        advice = "count from 0, or * for all"
        raise SceneError(f"override {key}: {part!r} is not one of its {len(target)} items; {advice}")
    if not isinstance(target, dict):
        raise SceneError(f"override {key}: {part!r} is not a table")
    return [target.setdefault(part, {})]


def _fill_in(data, defaults):
    for section, values in defaults.items():
        if section in OPTIONAL_SECTIONS and section not in data:
            continue
        table = data.setdefault(section, {})
        if isinstance(table, dict):
            _fill_table(table, values)


def _fill_table(table, values):
    for key, value in values.items():
        if not isinstance(value, dict):
            table.setdefault(key, value)
        elif isinstance(table.get(key), dict) or (key not in table and key not in OPTIONAL_SECTIONS):
            _fill_table(table.setdefault(key, {}), value)


def data_places():
    """Return the folders in which files of measured cases are looked for: MELT_DATA, or ../shared/data of a checkout."""
    given = os.environ.get("MELT_DATA")
    beside = [pathlib.Path("..") / "shared" / "data", pathlib.Path(__file__).resolve().parents[3] / "shared" / "data"]
    return [pathlib.Path(given)] if given else beside


def _resolve_files(item, places):
    """Make the files that a flood names absolute: beside the scene, or in one of `data_places`."""
    if isinstance(item, list):
        for inner in item:
            _resolve_files(inner, places)
    if not isinstance(item, dict):
        return
    for key, value in item.items():
        if key in ("file", "raster") and isinstance(value, str):
            there = (pathlib.Path(place) / value for place in [*places, *data_places()])
            found = next(filter(is_file, there), None)
            item[key] = str(found.resolve()) if found else value
        else:
            _resolve_files(value, places)


def _resolve_meshes(data, folder):
    """Make mesh files that stand beside the scene absolute, so that the scene works from anywhere."""
    fluid = data.get("fluid")
    placed = [data.get("solid"), data.get("obstacle"), fluid.get("fill") if isinstance(fluid, dict) else None]
    for items in placed:
        for item in items if isinstance(items, list) else []:
            if isinstance(item, dict) and isinstance(item.get("file"), str) and folder is not None:
                beside = pathlib.Path(folder) / item["file"]
                if is_file(beside):
                    item["file"] = str(beside.resolve())
