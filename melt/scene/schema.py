"""JSON Schema of scene files, for editors that check and complete TOML."""

from pydantic.json_schema import models_json_schema

from melt.scene.flood import FloodScene
from melt.scene.model import Scene

_PRESETS = {
    "type": "object",
    "description": "Presets of this scene: values by dotted key, by name of the preset ([presets.NAME]).",
    "additionalProperties": {"type": "object"},
}


def scene_schema():
    """Return the schema: a scene with a terrain is a flood, all others are liquids in a box; unknown keys fit neither."""
    chosen, schema = models_json_schema([(Scene, "validation"), (FloodScene, "validation")])
    references = [chosen[model, "validation"]["$ref"] for model in (Scene, FloodScene)]
    for reference in references:
        schema["$defs"][reference.rpartition("/")[2]]["properties"]["presets"] = _PRESETS
    liquid, flood = ({"$ref": reference} for reference in references)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "melt scene",
        "type": "object",
        "if": {"required": ["terrain"]},
        "then": flood,
        "else": liquid,
        **schema,
    }
