"""The sections [terrain] and [friction] of a flood: where the bed comes from, and how rough it is."""

import difflib
from typing import Annotated, Any, Literal

from pydantic import Field, StrictBool, field_validator, model_validator

from melt.errors import UnitError
from melt.geometry import terrain_shapes
from melt.scene.quantities import Length, NonNegative, Number, Positive, PositiveLength, Section

Pair = Annotated[list[Length], Field(min_length=2, max_length=2)]
Cell = PositiveLength | Annotated[list[PositiveLength], Field(min_length=2, max_length=2)]
Polygon = Annotated[list[Pair], Field(min_length=3)]
Line = Annotated[list[Pair], Field(min_length=2)]
LAWS = ("manning", "chezy", "darcy")


class Raised(Section):
    """Buildings or levees ([[terrain.raised]]): nodes inside are lifted, or become walls."""

    polygon: Polygon | None = None
    """Corners [[x, y], ...] in world coordinates."""
    line: Line | None = None
    """Axis of a levee, with its width."""
    width: PositiveLength | None = None
    """Width of a levee's crest."""
    file: str | None = None
    """CSV of polygons with columns x, y, or house_id, vertex, x, y."""
    height: Length | None = None
    """Lift above the bed; 3 m unless given."""
    crest: Length | None = None
    """Elevation of the top, in place of height; ground above it stays as it is."""
    wall: bool = False
    """No water enters, in place of a height."""

    @model_validator(mode="after")
    def _complete(self):
        given = [k for k in ("polygon", "line", "file") if getattr(self, k) is not None]
        if len(given) != 1:
            raise ValueError(f"give exactly one of polygon, line and file; given: {', '.join(given) or 'none'}")
        if (self.line is None) != (self.width is None):
            raise ValueError("a levee needs both line and width; polygons have no width")
        tops = [k for k in ("height", "crest") if getattr(self, k) is not None] + ["wall"] * self.wall
        if len(tops) > 1:
            raise ValueError(f"give one of height, crest and wall; given: {', '.join(tops)}")
        if not tops:
            self.height = 3.0
        return self


class Terrain(Section):
    """The bed: a raster file, a DEM that is at hand, or an analytic shape."""

    file: str | None = None
    """GeoTIFF, ESRI ASCII (.asc), NumPy (.npz, .npy) or HDF5 (.h5); relative to the scene."""
    source: Literal["jacksboro"] | None = None
    """A DEM that is installed anyway: "jacksboro", 344 x 403 nodes of 92 x 75 m, which matplotlib ships."""
    shape: str | None = None
    """An analytic bed, by name."""
    parameters: dict[str, Any] = {}
    """Parameters of the shape, by name."""
    cell: Cell | None = None
    """Node spacing of a shape, or of a file that has none: a number or [dx, dy]."""
    lower: Pair | None = None
    """South-west corner: a clip of a raster in world coordinates, or the extent of a shape."""
    upper: Pair | None = None
    """North-east corner."""
    nodata: Literal["wall", "fill", "open"] = "wall"
    """Nodes without elevation: water does not enter, they are filled from their rim, or water leaves there."""
    nodata_value: Number | None = None
    """Value that marks a node without elevation, for files that do not say so."""
    vertical_unit: Literal["m", "ft", "us-ft"] | None = None
    """Unit of the elevations; the file's unless given, else m."""
    scale: Number | None = None
    """Elevation is value * scale + offset; the file's unless given."""
    offset: Number | None = None
    crs: str | None = None
    """Reference system of a file that names none, such as "EPSG:32756"."""
    reproject: str | Literal[False] = False
    """Reference system to warp to: "utm" (the zone of its middle) or "EPSG:..."; false takes it as it is."""
    resample: Annotated[PositiveLength | StrictBool, Field(union_mode="left_to_right")] = False
    """true: a rotated raster is resampled to north-up; a number: resampled to that cell [m]."""
    raised: list[Raised] = []
    """Buildings and levees ([[terrain.raised]])."""
    sampler: Literal["bspline", "bilinear", "bicubic"] = "bspline"
    """Between nodes: quadratic B-spline (no overshoot), bilinear (the paper), Catmull-Rom."""

    @field_validator("shape")
    @classmethod
    def _known_shape(cls, value):
        if value is not None and value not in terrain_shapes.SHAPES:
            close = difflib.get_close_matches(value, terrain_shapes.SHAPES, 1)
            hint = f"did you mean {close[0]!r}? " if close else ""
            raise ValueError(f"there is no shape {value!r}; {hint}known: {', '.join(terrain_shapes.SHAPES)}")
        return value

    @field_validator("reproject")
    @classmethod
    def _known_system(cls, value):
        if value and value != "utm" and not value.upper().startswith("EPSG:"):
            raise ValueError(f'{value!r} is not allowed: it must be false, "utm" or "EPSG:" and a number')
        return value

    @field_validator("scale")
    @classmethod
    def _not_zero(cls, value):
        if value == 0:
            raise ValueError("a scale of 0 makes every terrain flat: give for instance 0.01")
        return value

    @model_validator(mode="after")
    def _one_source(self):
        given = [k for k in ("file", "source", "shape") if getattr(self, k) is not None]
        if len(given) != 1:
            raise ValueError(f"give exactly one of file, source and shape; given: {', '.join(given) or 'none'}")
        if self.lower is not None and self.upper is not None:
            if any(a >= b for a, b in zip(self.lower, self.upper)):
                raise ValueError(f"upper {self.upper} must exceed lower {self.lower} along both axes")
        return self

    @model_validator(mode="after")
    def _shape_complete(self):
        if self.shape is None:
            if self.parameters:
                raise ValueError("parameters belong to a shape: name it (shape), or remove them")
            return self
        if missing := [k for k in ("cell", "lower", "upper") if getattr(self, k) is None]:
            raise ValueError(f"a shape needs its extent and node spacing: {', '.join(missing)} missing")
        foreign = "nodata_value vertical_unit scale offset crs reproject resample".split()
        if foreign := [k for k in foreign if getattr(self, k) not in (None, False)]:
            raise ValueError(f"{', '.join(foreign)}: not for a shape, whose elevations are exact and in metres")
        try:
            self.parameters = terrain_shapes.check(self.shape, self.parameters)
        except UnitError as error:
            raise ValueError(f"parameters of {self.shape!r}: {error}") from None
        return self


class _Coefficients(Section):
    manning: NonNegative | None = None
    """Manning's n in s/m^(1/3)."""
    chezy: Positive | None = None
    """Chezy's C in m^(1/2)/s."""
    darcy: NonNegative | None = None
    """Darcy and Weisbach's f."""

    @property
    def given(self):
        """Names of the coefficients that are set."""
        return [law for law in LAWS if getattr(self, law) is not None]


class Zone(_Coefficients):
    """Part of the bed with a roughness of its own ([[friction.zone]]); later zones lie on earlier ones."""

    polygon: Polygon | None = None
    """Corners [[x, y], ...] in world coordinates."""
    file: str | None = None
    """CSV of polygons with columns x, y, or house_id, vertex, x, y."""

    @model_validator(mode="after")
    def _complete(self):
        if (self.polygon is None) == (self.file is None):
            raise ValueError("a zone needs either polygon or file")
        return self


class Friction(_Coefficients):
    """Friction of the bed."""

    law: Literal["manning", "chezy", "darcy"] = "manning"
    raster: str | None = None
    """Raster of coefficients, or of land cover classes with their table; sampled at the nearest node."""
    table: dict[str, NonNegative] | None = None
    """Coefficient of each land cover class, by its number."""
    zone: list[Zone] = []
    """Polygons with a roughness of their own ([[friction.zone]])."""

    @model_validator(mode="after")
    def _one_law(self):
        if wrong := [name for name in self.given if name != self.law]:
            raise ValueError(f"{wrong[0]} is not the coefficient of law = {self.law}: give {self.law}")
        for k, zone in enumerate(self.zone):
            if zone.given != [self.law]:
                raise ValueError(f"zone {k} needs {self.law} (and no other coefficient), as law = {self.law}")
        if self.table is not None and self.raster is None:
            raise ValueError("a table of land cover classes needs their raster")
        for cls in self.table or ():
            try:
                float(cls)
            except ValueError:
                raise ValueError(f"table: the class {cls!r} is not a number") from None
        if not self.given:
            if self.law != "manning":
                raise ValueError(f"law = {self.law} needs {self.law}")
            self.manning = 0.03  # natural channels and short grass
        return self

    @property
    def coefficient(self):
        """Coefficient of the law outside of zones and raster."""
        return getattr(self, self.law)
