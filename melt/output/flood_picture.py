"""Pictures of floods: water in screen space on the shaded terrain. Flood spec 5."""

import tomllib
from types import SimpleNamespace

import numpy as np

from melt.geometry.outlines import inside
from melt.output import camera as cameras
from melt.output import colours, relief
from melt.output.annotate import annotate
from melt.output.errors import OutputError
from melt.output.screen import Look, ScreenRenderer
from melt.physics.phases import AIRBORNE, LIQUID

WIDTH = 1.5  # radius of a column's sphere in spacings: neighbours of a stretched sheet still overlap (spec: at least 0.6)
FLAT = 0.08  # relief below this share of the width is drawn steeper, at most STEEPER times
STEEPER = 4.0
MARGIN = 0.12  # of the picture around the water, in its widths
#: (colours, unit) of false-colour fields; hazard is that of FD2320 without debris, d (v + 0.5).
FIELDS = {"depth": "m", "speed": "m/s", "hazard": "m^2/s"}


class FloodPainter:
    """Draws frames of one flood with one camera.

    Args:
        run: `Run`. field: depth, speed, hazard; all else draws water.
        view, size: see `melt.output.picture.Painter`. screen: smoothing (`melt.output.screen.SMOOTH`).
    """

    def __init__(self, run, field="water", view="iso", size=(1280, 720), screen=None, backend="cpu"):
        if view not in cameras.VIEWS:
            raise OutputError(f"unknown view '{view}': use {', '.join(cameras.VIEWS)}.")
        if len(run) == 0:
            raise OutputError(f"{run.path} has no frame yet: nothing to draw.")
        self.run = run
        if field not in (*FIELDS, "water", "temperature"):  # temperature is the command's default
            raise OutputError(f"a flood has no field '{field}' to draw: use water, {', '.join(FIELDS)}.")
        self.field = field if field in FIELDS else None
        low, high = self._wet_area()
        self.terrain, self.steeper = self._cut(low, high)
        z = self.terrain.elevation[np.isfinite(self.terrain.elevation)]
        self.colouring = self._colouring()
        box = np.array([*low, z.min()]), np.array([*high, max(z.max(), z.min() + 0.02 * (high - low).max())])
        self.camera = cameras.fit(*box, view, *size, margin=0.02, right=0.12 if self.field else 0.0)
        spacing = self._spacing()
        look = Look(clarity=2.0 * spacing)
        if self.field:
            look = Look(absorb=(1.0, 1.0, 1.0), clarity=0.1 * spacing, shine=0.3, ambient=0.7)
        self.renderer = ScreenRenderer(
            self.camera, backend, smooth=screen or "narrow", below=True, look=look, stops=self.colouring.stops if self.field else None,
        )

    def draw(self, k):
        """Return the picture of frame ``k``, (height, width, 3) uint8."""
        frame = self.run.frame(k, ["position", "phase", "depth", "velocity", "support_radius"])
        water = np.isin(frame["phase"], (LIQUID, AIRBORNE)) & np.isfinite(frame["position"]).all(axis=1)
        x = frame["position"][water].T.astype(float)
        x[2] *= self.steeper
        radius = WIDTH * frame["support_radius"][water] / self.ratio
        value = None
        if self.field:
            span = max(self.colouring.high - self.colouring.low, 1e-9)
            value = np.clip((self._values(frame)[water] - self.colouring.low) / span, 0, 1)
        picture = self.renderer.draw(x, self._within(x, radius), value, self.terrain)
        counts = f"{int(water.sum()):,} columns" + (f", heights x {self.steeper:.2g}" if self.steeper > 1 else "")
        return annotate(picture, self.run.times[k], self.colouring, counts)

    def _within(self, x, radius):
        """Return the radii (n,) [m] with which columns are drawn: none beyond the ground that is drawn, or out of its underside."""
        low = np.array(self.terrain.lower)
        high = low + np.array(self.terrain.cell) * (np.array(self.terrain.elevation.shape[::-1]) - 1)
        room = np.minimum(x[:2] - low[:, None], high[:, None] - x[:2]).min(axis=0)
        room = np.maximum(np.minimum(room, 0.5 * (x[2] - relief.base(self.terrain))), 0.0)
        return np.clip(np.minimum(radius, 2 * WIDTH * self._spacing()), 0.0, room)

    def _values(self, frame):
        speed = np.linalg.norm(frame["velocity"][:, :2], axis=1).astype(float)
        return {"depth": frame["depth"], "speed": speed, "hazard": frame["depth"] * (speed + 0.5)}[self.field]

    def _colouring(self):
        """Return the `Colouring` over up to 12 frames; of water there is none to show."""
        if self.field is None:
            return colours.Colouring("phase", "", 0.0, 1.0, ())
        most = 0.0
        for k in np.unique(np.linspace(0, len(self.run) - 1, min(12, len(self.run))).astype(int)):
            frame = self.run.frame(k, ["position", "phase", "depth", "velocity"])
            values = self._values(frame)[frame["phase"] == LIQUID]
            most = max(most, float(np.quantile(values, 0.995)) if len(values) else 0.0)
        return colours.Colouring(self.field, FIELDS[self.field], 0.0, most or 1.0, colours.SPEED)

    def _spacing(self):
        """Return the spacing of columns in water of the reference depth [m], and keep the support ratio."""
        scene = tomllib.loads(self.run.scene_text)
        self.ratio = float(scene["solver"]["support"])
        return float(scene["fluid"]["spacing"])

    def _wet_area(self):
        """Return the corners (2,) [m] around the water of the run."""
        low, high = np.full(2, np.inf), np.full(2, -np.inf)
        for k in np.unique(np.linspace(0, len(self.run) - 1, min(8, len(self.run))).astype(int)):
            x = self.run.frame(k, ["position"])["position"][:, :2]
            x = x[np.isfinite(x).all(axis=1)]
            if len(x):
                low, high = np.minimum(low, np.quantile(x, 0.002, axis=0)), np.maximum(high, np.quantile(x, 0.998, axis=0))
        facts, bed = self.run.map_facts, self.run.maps["bed"]
        ground = np.array(facts["lower"]), np.array(facts["lower"]) + np.array(facts["cell"]) * (np.array(bed.shape[::-1]) - 1)
        if not np.all(low <= high):  # dry: the whole terrain
            return ground
        margin = MARGIN * (high - low).max() + 2 * np.array(facts["cell"])
        low, high = low - margin, high + margin
        least = 0.4 * (high - low).max()  # a strip of terrain is no picture
        short = np.maximum(least - (high - low), 0)
        return np.maximum(low - short / 2, ground[0]), np.minimum(high + short / 2, ground[1])

    def _raise_obstacles(self, z, lower, cell):
        """Lift nodes (ny, nx) inside of the scene's obstacles by their height, in place."""
        facts, scene = self.run.map_facts, tomllib.loads(self.run.scene_text)
        origin, unit = np.asarray(facts["origin"], float), float(facts.get("unit", 1.0))
        nodes = np.stack([a.ravel() for a in np.meshgrid(*(lower[k] + cell[k] * np.arange(z.shape[1 - k]) for k in (0, 1)))])
        for given in scene.get("obstacle", []):
            outline = SimpleNamespace(**{"angle": None, "hole": None, **given})
            for name in ("centre", "polygon", "hole"):
                if getattr(outline, name, None) is not None:
                    setattr(outline, name, (np.array(getattr(outline, name)) * unit - origin).tolist())
            z += float(given.get("height", 3 * scene["fluid"]["reference_depth"])) * inside(outline, nodes).reshape(z.shape)

    def _cut(self, low, high):
        """Return (the terrain between two corners, the factor on heights)."""
        facts, bed = self.run.map_facts, self.run.maps["bed"].astype(float) - float(self.run.map_facts["datum"])
        lower, cell = np.array(facts["lower"]), np.array(facts["cell"])
        first = np.clip(np.floor((low - lower) / cell).astype(int), 0, np.array(bed.shape[::-1]) - 3)
        last = np.clip(np.ceil((high - lower) / cell).astype(int) + 1, first + 3, np.array(bed.shape[::-1]))
        z = bed[first[1] : last[1], first[0] : last[0]].copy()
        self._raise_obstacles(z, lower + first * cell, cell)
        rise = float(np.nanmax(z) - np.nanmin(z))
        steeper = float(np.clip(FLAT * (high - low).max() / max(rise, 1e-9), 1.0, STEEPER)) if rise > 0 else 1.0
        return SimpleNamespace(elevation=z * steeper, lower=tuple(lower + first * cell), cell=tuple(cell)), steeper
