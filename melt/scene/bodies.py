"""Scene tables that place matter: shapes, fluid, solids, inflow, obstacles."""

from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from melt.scene.quantities import (
    Angles,
    Conductivity,
    Density,
    Direction,
    DynamicViscosity,
    Expansion,
    HeatRate,
    LatentHeat,
    MeltingPoint,
    NonNegative,
    Number,
    Positive,
    PositiveCount,
    PositiveLength,
    PositiveSpeed,
    PositiveVector,
    Rate,
    Section,
    Seed,
    SpecificHeat,
    Temperature,
    Time,
    Vector,
    Velocity,
    quantity,
)
from melt.scene.slime import Flow

_NEEDS = {
    "box": ({"size"}, {"lower", "upper"}),
    "sphere": ({"radius"},),
    "cylinder": ({"radius", "height"},),
    "mesh": ({"file"},),
}
_OPTIONAL = {
    "box": set(),
    "sphere": set(),
    "cylinder": {"axis"},
    "mesh": {"scale", "particles", "rotate", "repair"},
}


class Placed(Section):
    """A shape at a place, sampled on the lattice of the domain: centres at lower + (i + 1/2) spacing."""

    shape: Literal["box", "sphere", "cylinder", "mesh"] = "box"
    position: Vector | None = None
    """Place of the shape's anchor."""
    anchor: Literal["centre", "base"] = "centre"
    """Point of the bounding box that stands at position: its centre, or the centre of its lower face."""
    size: PositiveVector | None = None
    """Edges of a box."""
    lower: Vector | None = None
    """Lower corner of a box (with upper, in place of position and size)."""
    upper: Vector | None = None
    radius: PositiveLength | None = None
    """Radius of a sphere or cylinder."""
    height: PositiveLength | None = None
    """Height of a cylinder."""
    axis: Literal["x", "y", "z"] | None = None
    """Axis of a cylinder, z unless given."""
    file: str | None = None
    """Mesh: a file that trimesh reads (relative to the scene), or a shipped one such as "duck"."""
    scale: Positive | None = None
    """Factor on the mesh's coordinates."""
    particles: PositiveCount | None = None
    """Wanted number of particles of a mesh: its scale is bisected to come within 2 %."""
    rotate: Angles | None = None
    """Rotations of the mesh about x, then y, then z."""
    repair: bool | None = None
    """Close the holes of a mesh that is not watertight."""

    @model_validator(mode="after")
    def _complete(self):
        keys = set().union(*_OPTIONAL.values(), *(need for needs in _NEEDS.values() for need in needs))
        given = {key for key in keys if getattr(self, key) is not None}
        options = _NEEDS[self.shape]
        fitting = [need for need in options if need <= given]
        if not fitting:
            needed = ", or ".join(" and ".join(sorted(need)) for need in options)
            raise ValueError(f"a {self.shape} needs {needed}")
        foreign = given - fitting[0] - _OPTIONAL[self.shape]
        if foreign:
            by = " and ".join(sorted(fitting[0]))
            raise ValueError(f"{', '.join(sorted(foreign))}: not for a {self.shape} given by {by}")
        if self.lower is not None:
            if self.position is not None:
                raise ValueError("position: give either position and size, or lower and upper")
            if any(a >= b for a, b in zip(self.lower, self.upper)):
                raise ValueError(f"upper {self.upper} must exceed lower {self.lower} along every axis")
        elif self.position is None:
            raise ValueError(f"a {self.shape} needs a position")
        if self.scale is not None and self.particles is not None:
            raise ValueError("particles: give either scale or particles")
        return self


class Fill(Placed):
    """A region filled with liquid at the start."""

    velocity: Velocity = [0.0, 0.0, 0.0]
    temperature: Temperature | None = None
    """Start temperature of this region; fluid.temperature unless given."""


class Fluid(Section):
    """The ambient liquid."""

    fill: list[Fill] = []
    """Regions filled at the start ([[fluid.fill]])."""
    jitter: Annotated[quantity("number", at_least=0, at_most=0.3), Field()] = 0.0
    """Random displacement of the liquid at the start in spacings (incompressible liquids)."""
    seed: Seed = 0
    """Of the jitter."""
    flow: Flow | None = None
    """Velocity field at the start (incompressible liquids)."""
    central: Annotated[quantity("number", at_least=0), Field()] = 0.0
    """Pull towards the origin per distance [1/s^2] (incompressible liquids)."""
    density: Density = 1000.0
    temperature: Temperature = 20.0
    viscosity: Literal["artificial", "laminar"] = "artificial"
    """Artificial viscosity alone, or laminar viscosity mu beside it."""
    alpha: NonNegative = 0.2
    """Artificial viscosity. Below 0.1 a resting column boils."""
    mu: DynamicViscosity = 1.0e-3
    """Dynamic viscosity of "laminar"."""
    solid_friction: NonNegative | None = None
    """Friction of liquid on solids; alpha unless given."""
    wall_friction: NonNegative | None = None
    """Friction of liquid on walls; alpha unless given, 0 is free slip."""
    sound_speed: PositiveSpeed | Literal["auto", "legal"] = "auto"
    """"auto": reference speed / sqrt(compression); "legal": such that dt / n_sub is just stable."""
    compression: Annotated[Positive, Field(le=0.1)] = 0.01
    """Relative compression that the automatic sound speed allows."""
    reference_speed: PositiveSpeed | None = None
    """Speed that "auto" reckons with, if larger than sqrt(2 g H) and the inflow's."""
    clamp: bool = True
    """Pressure is never negative."""
    enclosed: bool = False
    """Liquid fills all that walls leave it, so that there is no free surface and pressure is known but for a constant
    (incompressible liquids)."""
    freezes_to: str | None = None
    """Material that it freezes to with heat.refreeze; with melt_to = water that of the first solid that melts unless given."""
    expansion: Expansion = 0.0
    """Thermal expansion of the Boussinesq buoyancy; 0 is off."""
    reference_temperature: Temperature | None = None
    """Temperature without buoyancy; fluid.temperature unless given."""
    drag: Rate = 0.0
    """Rate of ambient drag; 0 is off."""
    xsph: NonNegative = 0.0
    """XSPH blend; 0 is off."""
    sigma: NonNegative = 0.0
    """Surface tension [N/m], as a pressure at air ghost particles (incompressible liquids); 0 is off."""
    surface_tension: NonNegative = 0.0
    """Cohesion of Becker and Teschner [m/s^2 per kg-weighted W]; 0 is off."""


class Solid(Placed):
    """An elastic body that may melt."""

    name: str = ""
    material: str | None = None
    """Name of the material; solids that share it share its values. The solid's name unless given."""
    density: Density = 917.0
    velocity: Velocity = [0.0, 0.0, 0.0]
    temperature: Temperature | None = None
    """Start temperature; -10 degC unless given."""
    melting_point: MeltingPoint = 0.0
    """Temperature at which exposed particles melt; "never" or inf for a body that stays solid."""
    conductivity: Conductivity | None = None
    """k in W/(m K) (2.22 unless given); K of the figures with heat.law = paper (30 unless given)."""
    specific_heat: SpecificHeat = 2050.0
    latent_heat: LatentHeat = 334000.0
    """Latent heat of fusion, used where heat.latent is on."""
    liquid_density: Density | None = None
    """Density of its own melt; as the ambient liquid for ice (density not given), else as the solid."""

    @model_validator(mode="after")
    def _own_melt(self):
        if self.liquid_density is None and "density" in self.model_fields_set:
            self.liquid_density = self.density
        return self


class Obstacle(Placed):
    """A body of wall particles, fixed or moving as it is told (moving: incompressible liquids)."""

    name: str = ""
    velocity: Velocity = [0.0, 0.0, 0.0]
    spin: Annotated[list[Number], Field(min_length=3, max_length=3)] = [0.0, 0.0, 0.0]
    """Angular velocity about its centre [1/s]."""
    motion: list[Annotated[list[Number], Field(min_length=4, max_length=4)]] = []
    """Rows of time [s] and velocity [m/s], linear between them, in place of velocity."""
    force: bool = False
    """Measure the force of the liquid on it, by pressure and by shear: series force/NAME/... (incompressible liquids)."""

    @property
    def moves(self):
        """Whether its particles are those of a moving body: it is driven, or its force is measured."""
        return self.driven or self.force

    @property
    def driven(self):
        """Whether it moves (a body that moves within itself does, too)."""
        return any(self.velocity) or any(self.spin) or bool(self.motion)

    @model_validator(mode="after")
    def _in_order(self):
        times = [row[0] for row in self.motion]
        if any(a >= b for a, b in zip(times, times[1:])):
            raise ValueError("motion: times must ascend")
        return self


class Inflow(Section):
    """A round nozzle that emits layers of liquid."""

    name: str = ""
    position: Vector
    """Centre of the nozzle."""
    direction: Direction
    radius: PositiveLength
    speed: PositiveSpeed
    temperature: Temperature | None = None
    """fluid.temperature unless given."""
    layers: PositiveCount
    """Layers to emit, one every spacing / speed seconds."""
    start: Time = 0.0
    hold: NonNegative = 0.0
    """Length of the nozzle in spacings, within which liquid keeps its speed (incompressible liquids); layers enter at its
    inner end, position is its outlet."""

    @field_validator("direction")
    @classmethod
    def _not_zero(cls, value):
        if not any(value):
            raise ValueError("the zero vector has no direction; give for instance [0, 0, -1]")
        return value


class Heater(Section):
    """A volume that heats or cools what is inside it."""

    shape: Literal["box", "sphere"] = "box"
    position: Vector
    """Centre."""
    size: PositiveVector | None = None
    """Edges of a box."""
    radius: PositiveLength | None = None
    """Radius of a sphere."""
    rate: HeatRate | None = None
    """Heat per volume and time in W/m^3 (K/s with heat.law = paper); negative cools."""
    temperature: Temperature | None = None
    """Temperature that it imposes (in place of rate)."""

    @model_validator(mode="after")
    def _complete(self):
        box = self.shape == "box"
        if (self.size is None) == box or (self.radius is None) != box:
            raise ValueError("a box heater needs size (and no radius), a sphere heater radius (and no size)")
        if (self.rate is None) == (self.temperature is None):
            raise ValueError("a heater needs either rate or temperature")
        return self
