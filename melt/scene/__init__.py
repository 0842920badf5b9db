"""Scenes: a TOML file that names geometry, matter, physics and numerics in SI units."""

from melt.scene.load import (
    data_folder,
    find_scene,
    load_scene,
    scene_from_dict,
    scene_from_toml,
    shipped_scenes,
)
from melt.scene.model import Scene
from melt.scene.presets import PRESETS

__all__ = [
    "PRESETS", "Scene", "data_folder", "find_scene", "load_scene", "scene_from_dict", "scene_from_toml",
    "shipped_scenes",
]
