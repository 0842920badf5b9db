"""The material table of a scene: row 0 the ambient liquid, then each solid and its own melt."""

import math

import numpy as np

from melt.errors import SceneError

_SHARED = ("density", "melting_point", "conductivity", "specific_heat", "latent_heat", "liquid_density")


def material_table(scene):
    """Return (arrays ``material_*``, names, row of each solid).

    Conductivities include ``heat.conductivity_scale``; without heat they and the melting points mean nothing.

    Raises:
        SceneError: solids that share a material differ in its values.
    """
    heat, own = scene.heat, scene.solver.melt_to == "own"
    scale = heat.conductivity_scale if heat else 1.0
    liquid = {
        "density": scene.fluid.density,
        "conductivity": (heat.conductivity if heat else 0.0) * scale,
        "specific_heat": heat.specific_heat if heat else 1.0,
        "melting_point": math.inf,
        "latent_heat": 0.0,
        "melts_to": 0,
        "freezes_to": -1,
    }
    names, rows, row_of, source = ["liquid"], [liquid], [], {}
    for solid in scene.solid:
        if solid.material in source:
            _same(source[solid.material][1], solid)
            row_of.append(source[solid.material][0])
            continue
        k = len(rows)
        source[solid.material] = (k, solid)
        row_of.append(k)
        rows.append(
            {
                "density": solid.density,
                "conductivity": (solid.conductivity or 0.0) * scale,
                "specific_heat": solid.specific_heat,
                "melting_point": solid.melting_point,
                "latent_heat": solid.latent_heat if heat and heat.latent else 0.0,
                "melts_to": k + 1 if own else 0,
                "freezes_to": -1,
            }
        )
        names.append(solid.material)
        if own:
            freezes = k if heat and heat.refreeze else -1
            rows.append({**liquid, "density": solid.liquid_density, "melts_to": k + 1, "freezes_to": freezes})
            names.append(f"{solid.material} melt")
    # of the first solid that melts: what never melts has no point to freeze at
    melting = [solid.material for solid in scene.solid if math.isfinite(solid.melting_point)]
    frozen = scene.fluid.freezes_to or (melting[0] if melting and not own else None)
    if heat and heat.refreeze and frozen:
        liquid["freezes_to"] = source[frozen][0]
    whole = {"melts_to", "freezes_to"}
    arrays = {
        f"material_{k}": np.array([r[k] for r in rows], np.int32 if k in whole else float) for k in liquid
    }
    return arrays, names, row_of


def _same(first, solid):
    for key in _SHARED:
        a, b = getattr(first, key), getattr(solid, key)
        if a != b:
            raise SceneError(
                f"solids {first.name!r} and {solid.name!r} share the material {solid.material!r}, not {key} "
                f"({a} and {b}): give them different materials or one value"
            )


def heater_table(heat):
    """Return the arrays ``heater_*`` of a `melt.scene.model.Heat` section (or None: no heaters)."""
    heaters = heat.heater if heat else []
    half = [
        [0.5 * s for s in h.size] if h.shape == "box" else [h.radius, h.radius, h.radius] for h in heaters
    ]
    return {
        "heater_shape": np.array([("box", "sphere").index(h.shape) for h in heaters], np.int32),
        "heater_centre": np.array([h.position for h in heaters], float).reshape(-1, 3).T.copy(),
        "heater_size": np.array(half, float).reshape(-1, 3).T.copy(),
        "heater_mode": np.array([h.rate is None for h in heaters], np.int32),
        "heater_value": np.array([h.temperature if h.rate is None else h.rate for h in heaters], float),
    }
