"""Scene tables of a flood that place water, obstacles and gauges, or take water away. Plane vectors are (x, y), z is up."""

import difflib
from typing import Any, Literal

from pydantic import model_validator

from melt.flood.profiles import PROFILES
from melt.scene.quantities import (
    Angle,
    Length,
    Polygon,
    PositiveLength,
    PositiveVector2,
    Section,
    Vector2,
    Velocity2,
    quantity,
)


def _box(lower, upper):
    """Refuse a box without a width.

    Raises:
        ValueError: upper not above lower.
    """
    if any(a >= b for a, b in zip(lower, upper)):
        raise ValueError(f"upper {upper} must exceed lower {lower} along both axes")


class Pool(Section):
    """A region with water at the start ([[fluid.fill]]): box, circle, polygon, or all of the domain."""

    lower: Vector2 | None = None
    """Lower corner of a box (with upper)."""
    upper: Vector2 | None = None
    centre: Vector2 | None = None
    """Middle of a circle (with radius)."""
    radius: PositiveLength | None = None
    polygon: Polygon | None = None
    """Corners of a polygon, in order."""
    depth: PositiveLength | None = None
    """Depth of the water, the same everywhere."""
    stage: Length | None = None
    """Elevation of the surface; the depth is what it stands above the bed."""
    profile: str | None = None
    """Name of an analytic start: thacker_planar, thacker_radial, thacker_channel, solitary, channel."""
    parameters: dict[str, Any] = {}
    """Parameters of the profile, by name, in SI."""
    velocity: Velocity2 = [0.0, 0.0]

    @model_validator(mode="after")
    def _complete(self):
        for pair in (("lower", "upper"), ("centre", "radius")):
            if (getattr(self, pair[0]) is None) != (getattr(self, pair[1]) is None):
                raise ValueError(f"{pair[0]} and {pair[1]}: give both, or neither")
        ways = [key for key in ("lower", "centre", "polygon") if getattr(self, key) is not None]
        if len(ways) > 1:
            raise ValueError(f"{' and '.join(ways)}: give one region, a box (lower, upper), a circle (centre, radius) or a polygon")
        if self.lower is not None:
            _box(self.lower, self.upper)
        given = [key for key in ("depth", "stage", "profile") if getattr(self, key) is not None]
        if self.profile is not None and self.profile not in PROFILES:
            close = difflib.get_close_matches(self.profile, PROFILES, 1)
            hint = f"did you mean {close[0]!r}? " if close else ""
            raise ValueError(f"there is no profile {self.profile!r}; {hint}known: {', '.join(PROFILES)}")
        if self.parameters and self.profile is None:
            raise ValueError("parameters belong to a profile: name it (profile), or remove them")
        if len(given) != 1:
            raise ValueError(f"give exactly one of depth, stage and profile, not {' and '.join(given) or 'none'}")
        return self


_NEEDS = {"box": {"centre", "size"}, "cylinder": {"centre", "radius"}, "polygon": {"polygon"}}
_OPTIONAL = {"box": {"angle"}, "cylinder": set(), "polygon": {"hole"}}


class FloodObstacle(Section):
    """A fixed body that water flows around ([[obstacle]])."""

    shape: Literal["box", "cylinder", "polygon"] = "box"
    centre: Vector2 | None = None
    """Middle of a box or cylinder."""
    size: PositiveVector2 | None = None
    """Edges of a box."""
    angle: Angle | None = None
    """Turn of a box about its middle, anticlockwise."""
    radius: PositiveLength | None = None
    """Radius of a cylinder."""
    polygon: Polygon | None = None
    """Corners of a polygon, in order."""
    hole: Polygon | None = None
    """Corners of a hole in the polygon."""
    spacing: PositiveLength | None = None
    """Spacing of its boundary points; half that of the water unless given."""
    height: PositiveLength | None = None
    """Height above the bed that it is drawn with."""

    @model_validator(mode="after")
    def _complete(self):
        keys = {"centre", "size", "angle", "radius", "polygon", "hole"}
        given = {key for key in keys if getattr(self, key) is not None}
        if missing := _NEEDS[self.shape] - given:
            raise ValueError(f"a {self.shape} needs {' and '.join(sorted(missing))}")
        if foreign := given - _NEEDS[self.shape] - _OPTIONAL[self.shape]:
            raise ValueError(f"{', '.join(sorted(foreign))}: not for a {self.shape}")
        return self


class Gauge(Section):
    """A place whose stage and speed are recorded ([[gauge]])."""

    name: str = ""
    position: Vector2


class Infiltration(Section):
    """Water that seeps away at a constant rate."""

    rate: quantity("speed", at_least=0)
