"""The scene of a flood: a [terrain] with water on it. Coordinates are those of the terrain file (world, metres)."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from melt.scene.flood_bodies import FloodObstacle, Gauge, Infiltration, Pool, Vector2, Velocity2
from melt.scene.model import About, Output, Time
from melt.scene.quantities import (
    Density,
    Length,
    NonNegative,
    Number,
    Positive,
    PositiveCount,
    PositiveLength,
    Section,
    Seed,
    Share,
    Spacing,
    quantity,
)
from melt.scene.terrain import Friction, Terrain
from melt.scene.watch import FloodWatch

Discharge = quantity("discharge", at_least=0)
SIDES = ("west", "east", "south", "north")


class Table(Section):
    """Values over time: inline pairs, or a CSV file of two columns (time in s, value in SI)."""

    table: list[tuple[Number, Number]] | None = None
    """Pairs [time, value], times ascending."""
    file: str | None = None
    """CSV with the columns time and value; relative to the scene, or to the folder MELT_DATA."""
    time_unit: Literal["s", "min", "h", "day"] = "s"
    scale: Number = 1.0
    """Factor on the values."""
    after: Literal["hold", "zero"] = "hold"
    """Beyond the last time: its value, or zero."""

    @model_validator(mode="after")
    def _one(self):
        if (self.table is None) == (self.file is None):
            raise ValueError("give either table = [[time, value], ...] or file = \"name.csv\"")
        return self


class Water(Section):
    """The water: columns of equal mass, the depth follows from how close they stand."""

    spacing: Spacing
    """Spacing r_0 of columns where the water is reference_depth deep."""
    reference_depth: PositiveLength = 1.0
    """A column holds spacing^2 reference_depth of water (layout equal_mass)."""
    layout: Literal["equal_mass", "equal_area", "hexagonal", "lattice"] = "equal_mass"
    """equal_area: spacing everywhere, mass follows the depth. lattice is for comparison: a flow along it decouples its rows."""
    jitter: Share = 0.4
    """Random displacement of equal_area and hexagonal layouts, in spacings, before they are evened out."""
    even: bool = True
    """Shift columns to an even spacing before the start."""
    calibrate: bool = False
    """Adjust the volume of each column until the depth there is what the fill says; not beside free edges of water."""
    settle: Annotated[quantity("time", at_least=0), Field()] = 0.0
    """Relaxation start: let the water come to rest for at most this long before t = 0."""
    seed: Seed = 0
    density: Density = 1000.0
    fill: list[Pool] = []
    """Water at the start ([[fluid.fill]])."""
    capacity: PositiveCount | None = None
    """Columns that the run has room for; what the inflows bring and half as much again unless given."""
    release_height: Annotated[quantity("length", at_least=0), Field()] = 0.0
    """Columns start this far above the terrain and fall (the paper's Figure 10); they join the flow where they land."""


class Boundary(Section):
    """Edges of the terrain."""

    west: Literal["wall", "open"] = "wall"
    east: Literal["wall", "open"] = "wall"
    south: Literal["wall", "open"] = "wall"
    north: Literal["wall", "open"] = "wall"
    columns: bool = True
    """Walls hold boundary particles that carry the stage of the water beside them; false leaves a hard edge alone."""
    spacing: Annotated[quantity("number", above=0, at_most=1), Field()] = 0.5
    """Spacing of boundary particles in fluid.spacing."""
    thickness: Positive = 1.0
    """Thickness of walls in support radii of water of the reference depth."""
    law: Literal["mirror", "paper"] = "mirror"
    """paper: boundary particles stand for water of the reference depth, whatever the stage."""


class Edge(Section):
    """A side at which stage, depth or discharge are given. Waves from inside come back from it, unless it is far."""

    side: Literal["west", "east", "south", "north"]
    stage: Length | Table | None = None
    """Elevation of the water surface."""
    depth: PositiveLength | Table | None = None
    discharge: Discharge | Table | None = None
    """Into the domain, over the whole width of the side."""
    far: bool = False
    """stage or depth is that of still water far outside: waves from inside leave, and the side takes what depth they have."""
    width: Positive = 4.0
    """Width of the strip in which the flow is driven, in support radii."""
    until: Annotated[quantity("time", above=0), Field()] | None = None
    """The side is left to itself (open) after this time."""

    @model_validator(mode="after")
    def _one(self):
        if sum(v is not None for v in (self.stage, self.depth, self.discharge)) != 1:
            raise ValueError("give one of stage, depth and discharge")
        if self.far and self.discharge is not None:
            raise ValueError("far belongs to a stage or a depth: still water far outside has no discharge")
        return self


class FloodInflow(Section):
    """Water that enters at a place with a given discharge."""

    name: str = ""
    discharge: Discharge | Table
    centre: Vector2 | None = None
    radius: PositiveLength | None = None
    polygon: Annotated[list[Vector2], Field(min_length=3)] | None = None
    line: Annotated[list[Vector2], Field(min_length=2, max_length=2)] | None = None
    velocity: Velocity2 = [0.0, 0.0]

    @model_validator(mode="after")
    def _place(self):
        disc = self.centre is not None and self.radius is not None
        if (self.centre is None) != (self.radius is None) or disc + (self.polygon is not None) + (self.line is not None) != 1:
            raise ValueError("give one place: centre and radius, polygon, or line")
        return self


class Rain(Section):
    """Rain over the whole terrain."""

    rate: quantity("speed", at_least=0) | Table
    """Water per area and time, such as "20 mm/h"."""


class Control(Section):
    """Terrain velocity control force: brakes columns over drops of the terrain."""

    mode: Literal["descent", "bead", "paper"] = "descent"
    slope_on: NonNegative = 0.3
    """Drop per metre from which it acts."""
    slope_full: NonNegative = 0.6
    """Drop per metre from which it acts fully."""
    spread: Positive = 0.25
    """Half the edge of the square of four points, in support radii.

    The paper's 1 brakes water that is still on flat ground before a drop: over a slope of 10 m in 5 m, with columns 0.25 m
    apart, it cuts the discharge by 44 %, by 11 % with ``clamp``, and by 0.1 % at 0.25 (by 9 % with columns 0.5 m apart); the
    bounds of speed and energy are the same (docs/results.md). A sheer step is dammed by any of them.
    """
    clamp: bool = True
    """Keep that length between half a cell of the terrain and two spacings; the paper does not."""

    @model_validator(mode="after")
    def _ordered(self):
        if self.slope_full < self.slope_on:
            raise ValueError(f"slope_full = {self.slope_full:g} must be at least slope_on = {self.slope_on:g}")
        return self


class FloodSolver(Section):
    """Numerical choices, each a knob of the speed-accuracy trade."""

    precision: Literal["single", "mixed", "double"] = "single"
    kernel: Literal["cubic", "wendland2"] = "wendland2"
    """Smoothing function. With the cubic spline columns pair up in long runs: in a lake at rest the nearest neighbour comes
    from 0.93 to 0.51 spacings in 6 s (1.01 with Wendland C2), and sums end 0.6 % low."""
    support: Annotated[quantity("number", at_least=1.8, at_most=6), Field()] = 2.66
    """Support radius of water of the reference depth, in spacings (twice the smoothing length)."""
    support_limits: Annotated[list[Positive], Field(min_length=2, max_length=2)] = [0.25, 5.0]
    """Support radii are kept between these multiples of it."""
    growth: Annotated[quantity("number", above=1, at_most=2), Field()] = 1.05
    """A support grows by at most this factor in a sub-step; neighbour lists reach that far.

    Ritter and Stoker at r_0 = 0.1 m have the same errors at 1.1, 1.05 and 1.03 (0.94 to 0.96 and 1.34 to 1.36 %).
    """
    iterations: Annotated[int, Field(ge=0, le=50)] = 5
    """Newton steps for depth and support; 0 is the paper's: the support of the sub-step before."""
    tolerance: Positive | None = None
    """Residual |R|/d of them: 1e-6 in single and mixed, 1e-10 in double precision unless given."""
    form: Literal["variational", "symmetric", "balanced", "linear"] = "variational"
    """Pressure and bed; balanced keeps a lake at rest exactly; linear is the paper's gas law."""
    bed: Literal["gradient", "constrained"] = "gradient"
    """constrained: columns follow the bed, a slope S drives with gS/(1 + S^2)."""
    alpha: NonNegative = 1.0
    """Lax-Friedrichs stabilisation."""
    viscosity: Annotated[quantity("diffusivity", at_least=0), Field()] = 0.0
    stiffness: Positive = 10.0
    """k of form = linear [m^2/s^2]."""
    clamp: bool = False
    """form = linear: no tension."""
    cfl: Annotated[quantity("number", above=0, at_most=0.7), Field()] = 0.3
    """Sub-steps of at most cfl l/(sqrt(g d) + |v|)."""
    first_kick: Literal["half", "full"] = "half"
    """full: symplectic Euler, the paper's."""
    max_neighbours: PositiveCount | None = None
    """Slots of a neighbour list to begin with."""
    top_speed: Annotated[quantity("speed", above=0), Field()] = 50.0
    """A faster column ends the run."""

    @model_validator(mode="after")
    def _ordered(self):
        if not self.support_limits[0] <= 1 <= self.support_limits[1]:
            raise ValueError(f"support_limits = {self.support_limits} must be [least, most] with least <= 1 <= most")
        return self


class FloodOutput(Output):
    """What goes into the run file and beside it."""

    maps: bool = True
    """Keep maps of largest depth, speed and of arrival time on the nodes of the terrain."""
    raster: Literal["auto", "tif", "asc", "none"] = "auto"
    """Write the maps beside the run file when it ends: GeoTIFF (with rasterio) or ESRI ASCII."""
    wet_depth: PositiveLength = 0.02
    """Depth from which a place counts as reached."""
    gauge_every: PositiveCount = 1
    """Outer steps between gauge readings."""


class FloodScene(Section):
    """A flood."""

    kind: ClassVar[str] = "flood"
    system: ClassVar[str] = "flood"
    scene: About = Field(default_factory=About)
    preset: str = "default"
    time: Time
    terrain: Terrain
    fluid: Water
    gravity: quantity("acceleration", above=0) = 9.81
    boundary: Boundary = Field(default_factory=Boundary)
    edge: list[Edge] = []
    inflow: list[FloodInflow] = []
    rain: Rain | None = None
    infiltration: Infiltration | None = None
    friction: Friction | None = None
    control: Control | None = None
    obstacle: list[FloodObstacle] = []
    gauge: list[Gauge] = []
    solver: FloodSolver = Field(default_factory=FloodSolver)
    watch: FloodWatch = Field(default_factory=FloodWatch)
    output: FloodOutput = Field(default_factory=FloodOutput)

    @model_validator(mode="after")
    def _together(self):
        for kind in ("inflow", "gauge"):
            for k, item in enumerate(getattr(self, kind)):
                item.name = item.name or f"{kind} {k}"
            names = [item.name for item in getattr(self, kind)]
            if twice := [n for n in names if names.count(n) > 1]:
                raise ValueError(f"the name {twice[0]!r} is given twice: names of inflows and of gauges are unique")
        sides = [e.side for e in self.edge]
        if twice := [s for s in sides if sides.count(s) > 1]:
            raise ValueError(f"edge: the side {twice[0]!r} is given twice")
        open_ = [side for side in SIDES if getattr(self.boundary, side) == "open"] + sides
        if self.fluid.settle > 0 and open_:
            raise ValueError(f"fluid.settle lets water come to rest within walls, it would leave over the side {open_[0]!r}: leave it out")
        if self.fluid.calibrate and self.solver.kernel != "cubic":
            raise ValueError("fluid.calibrate is written for the cubic spline: set solver.kernel = cubic, or calibrate = false")
        if self.solver.form in ("linear", "balanced") and self.solver.bed == "constrained":
            raise ValueError("solver.bed = constrained needs form = variational or symmetric")
        return self

    boiling: ClassVar[None] = None  # sections of other systems, which this one does not have
    heat: ClassVar[None] = None

    @property
    def spacing(self):
        """Spacing r_0 of columns in water of the reference depth [m]."""
        return self.fluid.spacing

    @property
    def support(self):
        """Support radius h_0 there [m]."""
        return self.solver.support * self.fluid.spacing

    @property
    def column_volume(self):
        """Volume of a column of equal mass [m^3]."""
        return self.fluid.spacing**2 * self.fluid.reference_depth

    def to_toml(self):
        """Return the scene as TOML text that loads to an equal scene."""
        from melt.scene.toml import dumps

        return dumps(self.model_dump(exclude_none=True))
