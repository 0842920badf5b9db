"""The section [boiling]: heat, bubbles and vapour of a liquid that boils. Boiling spec 2.3-2.6, 3, 4."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from melt.scene.quantities import (
    Count,
    Density,
    Expansion,
    LatentHeat,
    Length,
    NonNegative,
    Positive,
    PositiveCount,
    PositiveLength,
    PositiveSpeed,
    PositiveTime,
    Rate,
    Section,
    Share,
    SpecificHeat,
    Temperature,
    TemperatureDifference,
    quantity,
)

Pair = Annotated[list[Length], Field(min_length=2, max_length=2)]
Span = quantity("time", at_least=0)
PositivePair = Annotated[list[PositiveLength], Field(min_length=2, max_length=2)]


class FloorHeater(Section):
    """Heated rectangle of the floor ([boiling.heater]); liquid within a spacing of the floor touches it."""

    centre: Pair | None = None
    """Middle of the rectangle (x, y); the floor's unless given."""
    half_size: PositivePair | None = None
    """Half its edges; 0.2 of the floor's unless given."""
    temperature: Temperature = 115.0
    """T_h, which a heater with a rate rises to."""
    rate: Annotated[quantity("heating rate", above=0), Field()] | None = None
    """The heater starts at the liquid's temperature and rises by this rate; at once at T_h unless given."""
    mode: Literal["robin", "dirichlet"] = "robin"
    """"robin": liquid approaches T_h with a rate of transfer; "dirichlet": it has T_h (the paper)."""
    transfer: Rate = 4.0
    """k_h of "robin"."""


class BubbleLaws(Section):
    """How bubbles are born, grow, rise, merge and burst ([boiling.bubbles])."""

    capacity: Count | None = None
    """Slots for bubbles, twice the liquid particles unless given; what finds none waits as liquid at the boiling point."""
    radius_law: Literal["default", "paper"] = "default"
    """"default": r0 (1 + beta/alpha times rise and time), at most a third more; "paper": alpha h + beta (y - h) t."""
    alpha: Positive = 0.75
    beta: NonNegative = 0.25
    gas_density: Density = 0.6
    added_mass: Positive = 0.5
    """C_A: inertia is that of the gas and of C_A times the displaced liquid."""
    drag: Positive = 8 / 3
    """C_D; 8/3 makes the terminal speed sqrt(g r)."""
    merge_age: Span = 0.1
    """Younger bubbles do not merge: the four of one particle overlap at birth."""
    merge_position: Literal["centre", "mean"] = "centre"
    """"centre": by volume; "mean": plain mean (the paper)."""
    merge_velocity: Literal["momentum", "up"] = "momentum"
    """"up": the merged bubble keeps the vertical part only (the paper); what is removed is booked."""
    drift: NonNegative = 0.1
    """kappa of eq (13), per 1/60 s."""
    drift_form: Literal["normalised", "counts"] = "normalised"
    burst_radius: Positive = 0.45
    """r_s in spacings: smaller bubbles vanish, larger ones burst and push."""
    push_reach: Positive = 1.5
    """Reach of a burst in support radii."""
    push_side: NonNegative = 0.2
    """l_1 of eq (14)."""
    push_up: NonNegative = 0.3
    """l_2 of eq (14)."""
    push_time: PositiveTime = 1 / 60
    push_weight: Literal["linear", "even"] = "linear"

    @model_validator(mode="after")
    def _whole(self):
        if self.capacity is not None and self.capacity < 4:
            raise ValueError("capacity must hold the 4 bubbles of a particle at least")
        return self


class Vapour(Section):
    """Vapour above the surface as SPH smoke ([boiling.vapour])."""

    capacity: PositiveCount | None = None
    """Slots for vapour particles, as many as liquid particles unless given; new ones that find none are dropped."""
    per_burst: PositiveCount = 4
    """Particles that a burst sets free."""
    life: PositiveTime = 3.0
    drag: Rate = 1.0
    """Rate of slowing down in still air."""
    expansion: Expansion = 1 / 373
    """Of the gas, for its buoyancy."""
    stiffness: NonNegative = 2.0
    """k_v of p = k_v (rho - rho_0) [m^2/s^2]."""
    precision: bool = True
    """Eq (16): effect precision of vapour, from density and pressure."""
    density_share: Share = 0.5
    """a_S of eq (16)."""
    minimum_support: Share = 0.5
    """Smallest support radius in units of R'."""


class Boiling(Section):
    """A liquid heated from its floor until it boils. Needs solver.pressure = pbf or sph."""

    seed: int = 0
    """Of all random draws."""
    heat_model: Literal["particle", "particle10", "grid"] = "particle"
    """"particle": eq (11), conserves energy; "particle10": eq (10); "grid": eq (9), no advection."""
    diffusivity: Annotated[quantity("diffusivity", at_least=0), Field()] | None = None
    """alpha; 0.1 spacing^2 per 1/60 s unless given (the paper's number). Water has 1.6e-7."""
    specific_heat: SpecificHeat = 4186.0
    boiling_point: Temperature = 100.0
    latent_heat: LatentHeat = 2.257e6
    latent_scale: NonNegative = 0.02
    """Share of the latent heat that a particle must take up: 1 is physical, 0 makes boiling free of charge.

    What a particle has taken up it keeps when it cools again.
    """
    nucleation_time: Span = 0.3
    """Mean waiting time of a particle that could boil; 0 boils at once."""
    mass_model: Literal["cargo", "nucleate", "recycle"] = "cargo"
    """"cargo": bubbles carry the particle's mass and release it; "nucleate": the particle stays; "recycle": what is
    released returns as liquid of the temperature of the air, in whole particles at random places of the surface."""
    subcooling: TemperatureDifference = 2.0
    """Of "nucleate": a particle cools by this when it sends out bubbles."""
    surface_transfer: Rate = 0.0
    """Rate at which the surface approaches the air's temperature."""
    air_temperature: Temperature = 20.0
    """Of the air above the surface, of condensate that returns, and of the air that vapour rises in."""
    boost: Literal["off", "rate", "literal", "boussinesq", "viscosity"] = "rate"
    """Velocity boost, eq (12)."""
    boost_rate: NonNegative = 0.5
    """k_T [1/s]; of "literal" a factor per step."""
    boost_speed: PositiveSpeed = 0.5
    """v_b: faster than this, warmth no longer speeds up."""
    expansion: Expansion = 5e-4
    """Of "boussinesq"."""
    heater: FloorHeater | None = None
    """Nothing is heated without it."""
    bubbles: BubbleLaws = Field(default_factory=BubbleLaws)
    vapour: Vapour | None = None
    """Vapour above the surface, if the section is present."""

    @model_validator(mode="after")
    def _possible(self):
        if self.seed < 0:
            self.seed &= (1 << 64) - 1
        return self


def check_boiling(scene):
    """Refuse, in words, what does not go together with boiling.

    Raises:
        ValueError: with the remedy.
    """
    if scene.solver.pressure == "wcsph":
        raise ValueError("[boiling] needs solver.pressure = pbf (position based fluid) or sph (the paper's baseline)")
    if scene.heat is not None:
        _one_specific_heat(scene)
    if not scene.solver.motion:
        raise ValueError("[boiling] needs solver.motion = true: bubbles rise")
    if abs(scene.domain.gravity[0]) + abs(scene.domain.gravity[1]) > 0 or scene.domain.gravity[2] > 0:
        raise ValueError("[boiling] wants gravity to point down z: domain.gravity = [0, 0, -g]")
    if "z-" not in scene.domain.walls.sides:
        raise ValueError("[boiling] needs a floor: add 'z-' to domain.walls.sides")
    b = scene.boiling
    if scene.domain.leave == "delete":
        raise ValueError("[boiling] keeps count of all its liquid: domain.leave = keep")
    if b.heat_model == "grid" and (b.surface_transfer > 0 or b.mass_model != "cargo"):
        raise ValueError(
            "boiling.heat_model = grid takes all temperatures from its grid: without surface_transfer, and with mass_model = cargo"
        )
    if b.boost == "viscosity" and (scene.solver.pressure == "sph" or scene.solver.pbf.xsph == 0):
        raise ValueError("boiling.boost = viscosity scales solver.pbf.xsph: set pressure = pbf and xsph above 0, or another boost")
    if scene.fluid.temperature > scene.boiling.boiling_point:
        raise ValueError(
            f"fluid.temperature = {scene.fluid.temperature:g} degC is above boiling.boiling_point = "
            f"{scene.boiling.boiling_point:g} degC: liquid starts at the boiling point at most"
        )


def _one_specific_heat(scene):
    """Let [boiling] and [heat] have the liquid's specific heat that one of them gives; `ValueError` if both do, differently."""
    given = [s for s in (scene.boiling, scene.heat) if "specific_heat" in s.model_fields_set]
    values = {s.specific_heat for s in given} or {scene.heat.specific_heat}
    if len(values) > 1:
        raise ValueError(
            f"boiling.specific_heat = {scene.boiling.specific_heat:g} and heat.specific_heat = {scene.heat.specific_heat:g} "
            "are of one liquid: give it once"
        )
    scene.boiling.specific_heat = scene.heat.specific_heat = values.pop()
