"""The section [domain]: the box, its lattice, walls, periodic axes."""

import math
from typing import Literal

from pydantic import Field, field_validator, model_validator

from melt.scene.quantities import Acceleration, PositiveCount, PositiveLength, Section, Spacing, Vector

SIDES = ("x-", "x+", "y-", "y+", "z-", "z+")
_SIDE_NAMES = {"floor": ("z-",), "lid": ("z+",), "sides": SIDES[:4], "all": SIDES, "none": ()}


class Walls(Section):
    """Layers of fixed particles around the domain."""

    sides: list[Literal["x-", "x+", "y-", "y+", "z-", "z+"]] = ["x-", "x+", "y-", "y+", "z-"]
    """Sides with a wall: x- x+ y- y+ z- z+, or floor, sides, lid, all, none."""
    layers: PositiveCount = 3
    height: PositiveLength | None = None
    """Height of the side walls; the domain's unless given."""

    @field_validator("sides", mode="before")
    @classmethod
    def _named(cls, value):
        names = [value] if isinstance(value, str) else value
        if not isinstance(names, list):
            return value
        sides = [s for name in names for s in (_SIDE_NAMES.get(name, (name,)) if isinstance(name, str) else (name,))]
        return [s for s in SIDES if s in sides] + [s for s in sides if s not in SIDES]


class Domain(Section):
    """The box that holds the scene, its lattice and its walls. z is up."""

    lower: Vector = [0.0, 0.0, 0.0]
    upper: Vector
    spacing: Spacing = 0.2
    """Particle spacing dx; particle centres are at lower + (i + 1/2) dx."""
    gravity: Acceleration = [0.0, 0.0, -9.81]
    walls: Walls = Field(default_factory=Walls)
    dimensions: Literal[2, 3] = 3
    """2: a plane of particles at y = 0, per metre of depth; lower and upper are taken in x and z. Incompressible liquids only."""
    periodic: list[Literal["x", "y", "z"]] = []
    """Axes along which the domain repeats. Incompressible liquids only."""
    leave: Literal["keep", "delete"] = "keep"
    """What becomes of particles far outside: they are counted, and kept or made inactive."""

    @model_validator(mode="after")
    def _box(self):
        if self.dimensions == 2:
            self.lower[1], self.upper[1] = -0.5 * self.spacing, 0.5 * self.spacing
        if any(a >= b for a, b in zip(self.lower, self.upper)):
            raise ValueError(f"upper {self.upper} must exceed lower {self.lower} along every axis")
        if self.dimensions == 2 and "y" in self.periodic:
            raise ValueError("periodic: in two dimensions there is no y, use x and z")
        for axis in self.periodic:
            k = "xyz".index(axis)
            length = (self.upper[k] - self.lower[k]) / self.spacing
            if abs(length - round(length)) > 1e-6 or round(length) < 3:
                raise ValueError(f"periodic axis {axis} is {length:g} spacings long: make it a whole number of at least 3")
        open_ends = [side for side in SIDES if side[0] in self.periodic or (self.dimensions == 2 and side[0] == "y")]
        self.walls.sides = [side for side in self.walls.sides if side not in open_ends]
        return self

    @property
    def cells(self):
        """Lattice cells along x, y, z; a fraction of a spacing counts as a whole one."""
        return tuple(max(1, math.ceil((b - a) / self.spacing - 1e-6)) for a, b in zip(self.lower, self.upper))
