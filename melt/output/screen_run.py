"""Liquid of a run in screen space, behind and in front of what `melt.output.shade.Stage` draws."""

import numpy as np

from melt.output import gas as gases
from melt.output.colours import PHASE
from melt.output.screen import Look, ScreenRenderer

RADIUS = 0.62  # of a particle [spacings]: neighbours on a cubic lattice overlap
#: Lengths over which water and coloured liquid lose their transparency [spacings].
CLEAR, COLOURED = 22, 4


class ScreenLiquid:
    """Draws the liquid of one run, coloured as its `Colouring` says: places on its map, or water without a map.

    Args:
        smooth: see `ScreenRenderer`. spacing: of the particles [m].
    """

    def __init__(self, smooth, colouring, spacing):
        self.smooth, self.colouring, self.spacing = smooth, colouring, spacing
        self._renderer = None

    def _made(self, stage):
        if self._renderer is None or self._renderer.camera is not stage.camera:
            stops = self.colouring.stops or None
            look = Look(body=tuple(PHASE[0] * 0.6), clarity=CLEAR * self.spacing)
            if stops:
                look = Look(absorb=(1.0, 1.0, 1.0), clarity=COLOURED * self.spacing, shine=0.4, ambient=0.62)
            self._renderer = ScreenRenderer(stage.camera, smooth=self.smooth, look=look, stops=stops)
        return self._renderer

    def draw(self, stage, solid, maps, position, values, gas=None):
        """Return the picture (h, w, 3) in 0 .. 1, as `Stage.draw` and, with a `Gas`, `gas.draw` do.

        position (n, 3) [m]; values (n,) of the field that colours the liquid.
        """
        renderer = self._made(stage)
        span = self.colouring.high - self.colouring.low
        place = None
        if self.colouring.stops:
            place = np.clip(np.nan_to_num((values - self.colouring.low) / (span if span > 0 else 1.0)), 0, 1)
        shapes = np.ascontiguousarray(position.T), np.full(len(position), RADIUS * self.spacing), place
        picture, behind, _ = stage.ground(solid, maps)
        renderer.set_behind(picture, behind)
        if gas is None:
            return np.moveaxis(renderer.planes(*shapes), 0, 2)
        return gases.draw(stage, solid, renderer.layer(*shapes), maps, "mesh", gas)
