"""Gas in pictures: bubbles inside the liquid, seen through its surface, and vapour above it.

A picture is composed from back to front: ground and solids, bubbles within the liquid (each dims what is behind
it by the liquid in between), the liquid with the length of the ray in front of the first bubble, bubbles that
stand out of it, vapour.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from melt.output import splat
from melt.output.shade import Spheres, numbers
from melt.physics.phases import BUBBLE, LIQUID, VAPOUR

PUFF = 2.2  # radius of a vapour particle [spacings]
HAZE = 0.35  # optical depth of one, through its middle
FILL = 0.32  # share of a ray through drawn liquid particles that lies inside of them


class Gas(NamedTuple):
    """Bubbles with their own radii, and puffs of vapour; colours are not used."""

    bubbles: Spheres
    vapour: Spheres


def of(frame, phase, seen, spacing):
    """Return the `Gas` of a frame that has the field ``bubble_radius``."""
    x, radius = frame["position"], np.asarray(frame["bubble_radius"], np.float64)
    bubble = seen & (phase == BUBBLE) & np.isfinite(radius) & (radius > 0)
    vapour = seen & (phase == VAPOUR)
    none = np.zeros((0, 3), np.float32)
    return Gas(
        Spheres(x[bubble], radius[bubble], none), Spheres(x[vapour], np.full(vapour.sum(), PUFF * spacing), none)
    )


def filled(frame, phase, values, bubbles, spacing):
    """Return frame and values with the bubbles in the liquid filled up, so that its surface passes over them.

    Lattice points stand in for the liquid that a bubble displaces, each with the value of the nearest liquid.
    Bubbles out of the liquid's reach are left alone.
    """
    liquid = np.flatnonzero((phase == LIQUID) & np.isfinite(frame["position"]).all(axis=1))
    if not len(liquid) or not len(bubbles.centre):
        return frame, values
    tree = cKDTree(frame["position"][liquid])
    inside = tree.query(bubbles.centre)[0] < bubbles.radius + 1.2 * spacing
    points = [_ball(x, r, spacing) for x, r in zip(bubbles.centre[inside], bubbles.radius[inside])]
    if not points:
        return frame, values
    points = np.concatenate(points)
    points = points[tree.query(points)[0] > 0.5 * spacing]  # where there is liquid already none is missing
    nearest = liquid[tree.query(points)[1]]
    more = {"position": points.astype(frame["position"].dtype), "phase": np.full(len(points), LIQUID, phase.dtype)}
    more |= {"material": frame["material"][nearest]} if "material" in frame else {}
    whole = {name: np.concatenate([{**frame, "phase": phase}[name], rows]) for name, rows in more.items()}
    return whole, np.concatenate([values, values[nearest]])


def _ball(centre, radius, spacing):
    """Return lattice points (n, 3) in a ball; its centre is one of them."""
    reach = int(radius / spacing)
    axis = np.arange(-reach, reach + 1) * spacing
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    return centre + points[(points**2).sum(axis=1) <= radius**2]


def draw(stage, solid, liquid, maps, style, gas):
    """Return the picture (h, w, 3) of a `shade.Stage` as `Stage.draw` does, with a `Gas` in it."""
    picture, behind, light = stage.ground(solid, maps)
    wet = liquid.depth < behind
    through = liquid.inside if style == "mesh" else liquid.inside / np.float32(FILL)
    last = np.where(wet, np.minimum(liquid.depth + through, behind), np.float32(0)).astype(np.float32)
    first = last.copy()
    picture = np.ascontiguousarray(picture, np.float32).copy()
    order = np.argsort(-stage.camera.view(gas.bubbles.centre)[:, 2], kind="stable")
    bubbles = Spheres(gas.bubbles.centre[order], gas.bubbles.radius[order], gas.bubbles.rgb)
    entry = np.where(wet, liquid.depth, np.float32(np.inf)).astype(np.float32)
    _bubbles(stage, bubbles, entry, behind, liquid.rgb, last, picture)
    ahead = last - liquid.depth if style == "mesh" else (last - liquid.depth) * np.float32(FILL)
    length = np.where(wet & (last < first), np.clip(ahead, 0, liquid.inside), liquid.inside)
    picture = stage.add_liquid(picture, behind, liquid, light, style, length, wet & (last < first))
    front = np.minimum(entry, behind)
    picture = np.ascontiguousarray(picture, np.float32)
    _bubbles(stage, bubbles, np.zeros_like(front), front, liquid.rgb, np.zeros_like(front), picture)
    return _vapour(stage, gas.vapour, front, picture)


def _bubbles(stage, bubbles, near, far, tint, last, picture):
    if not len(bubbles.centre):
        return
    centre = stage.camera.view(bubbles.centre).astype(np.float32)
    up = stage.camera.axes[:, 2].astype(np.float32)
    splat.bubbles(
        centre, bubbles.radius.astype(np.float32), *numbers(stage.camera), near, far.astype(np.float32),
        np.ascontiguousarray(tint), stage.light, stage.half, up, np.float32(1 / (16 * stage.spacing)), last, picture,
    )


def _vapour(stage, vapour, far, picture):
    if not len(vapour.centre):
        return picture
    total, bright = np.zeros(far.shape, np.float32), np.zeros(far.shape, np.float32)
    centre = stage.camera.view(vapour.centre).astype(np.float32)
    up = stage.camera.axes[:, 2].astype(np.float32)
    splat.puffs(
        centre, vapour.radius.astype(np.float32), *numbers(stage.camera), far.astype(np.float32), -up[1], total, bright
    )
    share = (1 - np.exp(-np.float32(HAZE) * total))[..., None]
    lit = (bright / np.maximum(total, np.float32(1e-6)))[..., None]
    cloud = np.array([0.82, 0.85, 0.88], np.float32) * (1 - lit) + lit
    return picture * (1 - share) + cloud * share
