"""The scene model. A section that is present is physics that the run needs."""

import difflib
import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from melt.errors import InputError
from melt.scene.bodies import Fluid, Heater, Inflow, Obstacle, Solid
from melt.scene.boiling import Boiling, check_boiling
from melt.scene.domain import Domain
from melt.scene.pbf import check_pbf
from melt.scene.quantities import (
    Conductivity,
    Count,
    HeatTransfer,
    NonNegative,
    Positive,
    PositiveCount,
    PositiveTime,
    Section,
    SpecificHeat,
    Temperature,
    TemperatureDifference,
)
from melt.scene.slime import INCOMPRESSIBLE, Elastic, Viscosity, check_incompressible
from melt.scene.solver import SYSTEM_OF, Solver
from melt.scene.watch import Watch

#: Particle fields that a run file may have.
OUTPUT_FIELDS = (
    "id phase material position velocity density pressure temperature latent_energy constraint effect_precision"
    " density_ratio viscosity bubble_radius age cargo latent_store depth bed support_radius brake"
).split()
MOST_STEPS = 1_000_000_000
MOST_SUBSTEPS = 1_000_000  # of an outer step
#: Thermal sub-steps of a step: more are refused, not waited for.
SUBSTEPS_LIMIT = 10_000


class About(Section):
    """Name of the scene and what it stands for."""

    name: str = "scene"
    description: str = ""
    figure: str = ""
    """Paper figure or experiment that the scene stands for."""
    exact: Literal["couette", "poiseuille", "vortices", "hydrostatic", "rotation", "ellipse", "dam", "pool", "rest"] | None = None
    """Exact solution that its errors are measured by (melt tradeoff); a converged run of it unless given."""


class Time(Section):
    """Length of the run and its steps."""

    end: Annotated[PositiveTime, Field()]
    """Simulated time."""
    dt: PositiveTime = 0.005
    """Outer step: heat, melting and topology once each."""
    n_sub: Annotated[int, Field(gt=0, le=MOST_SUBSTEPS)] | Literal["auto"] = "auto"
    """Mechanical sub-steps per outer step."""
    n_sub_max: Annotated[int, Field(gt=0, le=MOST_SUBSTEPS)] = 16
    output_every: PositiveTime = 0.05
    """Time between frames, rounded to whole outer steps."""
    checkpoint_every: PositiveTime | Literal["never"] | None = None
    """Time between checkpoints, from which a killed run resumes; with every frame unless given."""

    def steps_to(self, end):
        """Return the outer steps to a time [s]; `InputError` if they are so many that no run comes to its end."""
        steps = end / self.dt
        if steps > MOST_STEPS:
            raise InputError(
                f"{steps:.3g} steps of time.dt = {self.dt:g} s to t = {end:g} s are more than {MOST_STEPS:.0e}: "
                "lower time.end (or --until), or raise time.dt"
            )
        return math.ceil(steps - 1e-9)

    @property
    def steps(self):
        """Outer steps of the run."""
        return max(1, self.steps_to(self.end))

    @property
    def output_steps(self):
        """Outer steps between frames."""
        return max(1, round(self.output_every / self.dt))

    @property
    def checkpoint_steps(self):
        """Outer steps between checkpoints, 0 for none."""
        if self.checkpoint_every is None:
            return self.output_steps
        return 0 if self.checkpoint_every == "never" else max(1, round(self.checkpoint_every / self.dt))


class Heat(Section):
    """Heat exchange, melting and freezing."""

    law: Literal["paper", "physical"] = "paper"
    """"paper": diffusivity K_i + K_j, equal heat capacities; "physical": conductivity, heat capacity."""
    conductivity: Conductivity | None = None
    """Of the liquid: 0.56 W/(m K) unless given; with law = paper, K as in the figures, 10 unless given."""
    conductivity_scale: NonNegative | None = None
    """Factor on all conductivities: 0.01 with law = paper (figures give percent), else 1, unless given."""
    specific_heat: SpecificHeat = 4187.0
    """Of the liquid."""
    solver: Literal["auto", "pairs_seq", "pairs_coloured", "onesided", "cg", "explicit"] = "auto"
    """"auto": coloured pairs up to a Fourier number of 0.5, conjugate gradients above."""
    sweep_dt: Literal["half", "full"] = "half"
    """Step of each of the two pair sweeps; "full" is the paper's and transports twice the heat."""
    volume: Literal["rest", "current"] = "rest"
    """Volumes of the exchange: "rest" conserves energy, "current" is the paper's m/rho."""
    substeps: Annotated[int, Field(gt=0, le=SUBSTEPS_LIMIT)] | Literal["auto"] = 1
    """Thermal sub-steps; "auto" brings the Fourier number below 0.5."""
    tolerance: Positive | None = None
    """Relative residual of cg: 1e-5 in single and mixed, 1e-8 in double precision unless given."""
    max_iterations: PositiveCount = 200
    """Cap of cg iterations."""
    latent: bool = False
    """Melting takes up latent heat."""
    refreeze: bool = False
    """Cold liquid joins a neighbouring body."""
    hysteresis: TemperatureDifference = 0.5
    """Freezing starts this far below the melting point."""
    freeze_layers: Count = 2
    """Layers of vacant lattice sites around each body that liquid may freeze to."""
    nuclei: Count = 0
    """Bodies that cold liquid may start away from solids, of (2 freeze_layers + 1)^3 particles at most; 0 is off."""
    ambient_temperature: Temperature | None = None
    """Temperature of the air above free surfaces."""
    ambient_transfer: HeatTransfer = 0.0
    """Heat transfer coefficient of free surfaces; 0 insulates them."""
    wall_temperature: Temperature | None = None
    """Fixed temperature of the walls; insulated unless given."""
    heater: list[Heater] = []
    """Heated or cooled volumes ([[heat.heater]])."""

    @model_validator(mode="after")
    def _complete(self):
        if self.ambient_transfer > 0 and self.ambient_temperature is None:
            raise ValueError("ambient_transfer needs ambient_temperature")
        if self.nuclei > 0 and not self.refreeze:
            raise ValueError("nuclei are bodies that freeze out of the liquid: set refreeze = true, or nuclei = 0")
        paper = self.law == "paper"
        if self.conductivity is None:
            self.conductivity = 10.0 if paper else 0.56
        if self.conductivity_scale is None:
            self.conductivity_scale = 0.01 if paper else 1.0
        return self


class Output(Section):
    """What goes into the run file."""

    fields: list[str] | Literal["all"] = "all"
    """Particle fields to write; "all" that the scene has."""
    walls: bool = False
    """Write wall particles too."""
    compress: bool = True

    @field_validator("fields")
    @classmethod
    def _known(cls, value):
        for name in value if isinstance(value, list) else ():
            if name not in OUTPUT_FIELDS:
                close = difflib.get_close_matches(name, OUTPUT_FIELDS, 1)
                hint = f"did you mean {close[0]!r}? " if close else ""
                raise ValueError(f"there is no field {name!r}; {hint}known: {', '.join(OUTPUT_FIELDS)}")
        return value


class Scene(Section):
    """One scene: geometry, matter, physics, numerics."""

    kind: ClassVar[str] = "liquid"  # in a box; the other kind is "flood"
    scene: About = Field(default_factory=About)
    preset: str = "default"
    """Values of keys that are not given: "default", "paper", "physical", or one of the scene's own."""
    time: Time
    domain: Domain
    fluid: Fluid = Field(default_factory=Fluid)
    solid: list[Solid] = []
    heat: Heat | None = None
    boiling: Boiling | None = None
    viscosity: Viscosity | None = None
    elastic: Elastic | None = None
    inflow: list[Inflow] = []
    obstacle: list[Obstacle] = []
    solver: Solver = Field(default_factory=Solver)
    watch: Watch = Field(default_factory=Watch)
    output: Output = Field(default_factory=Output)

    @model_validator(mode="after")
    def _together(self):
        paper = self.heat is not None and self.heat.law == "paper"
        if self.solver.melt_to == "own" and self.solver.density_form == "number" and self.solver.pressure == "wcsph":
            raise ValueError("solver.melt_to = own makes unequal volumes: set solver.density_form = volume")
        if self.fluid.sound_speed == "legal" and self.time.n_sub == "auto":
            raise ValueError(
                "fluid.sound_speed = legal follows from the sub-step: set time.n_sub to a number"
            )
        if self.solver.pressure in ("pbf", "sph"):
            check_pbf(self)
        self._check_incompressible()
        if self.boiling is not None:
            check_boiling(self)
        if not self.solver.motion and self.heat is None:
            raise ValueError("solver.motion = false leaves nothing to do: add a [heat] section")
        for k, solid in enumerate(self.solid):
            solid.name = solid.name or f"solid {k}"
            solid.material = solid.material or solid.name
            if solid.liquid_density is None:
                solid.liquid_density = self.fluid.density
            if self.heat is not None:
                solid.temperature = -10.0 if solid.temperature is None else solid.temperature
                if solid.conductivity is None:
                    solid.conductivity = 30.0 if paper else 2.22
        materials = [solid.material for solid in self.solid]
        if self.fluid.freezes_to is not None and self.fluid.freezes_to not in materials:
            raise ValueError(
                f"fluid.freezes_to = {self.fluid.freezes_to!r} is no solid's material; there are {materials}"
            )
        never = [solid.material for solid in self.solid if not math.isfinite(solid.melting_point)]
        if self.fluid.freezes_to in never:
            raise ValueError(
                f"fluid.freezes_to = {self.fluid.freezes_to!r} never melts, so no liquid freezes to it: give it a melting_point"
            )
        if self.heat is not None and self.heat.nuclei > 0:
            if len(never) == len(self.solid):
                raise ValueError(
                    "heat.nuclei needs to know what the liquid becomes: add a [[solid]] that melts, whose material it takes"
                )
        for k, nozzle in enumerate(self.inflow):
            nozzle.name = nozzle.name or f"inflow {k}"
        for kind in (self.solid, self.inflow):
            names = [item.name for item in kind]
            if twice := [n for n in names if names.count(n) > 1]:
                raise ValueError(
                    f"the name {twice[0]!r} is given twice: names of solids and inflows are unique"
                )
        return self

    def _check_incompressible(self):
        if self.incompressible:
            return check_incompressible(self)
        only = {
            "[viscosity] (of weakly compressible liquids: fluid.viscosity)": self.viscosity is not None,
            "[elastic]": self.elastic is not None,
            "domain.dimensions = 2": self.domain.dimensions == 2,
            "domain.periodic": bool(self.domain.periodic),
            "fluid.central": self.fluid.central > 0,
            "fluid.jitter": self.fluid.jitter > 0,
            "fluid.sigma": self.fluid.sigma > 0,
            "[fluid.flow]": self.fluid.flow is not None,
            "fluid.enclosed": self.fluid.enclosed,
            "obstacle.velocity, spin, motion or force": any(o.moves for o in self.obstacle),
            "inflow.hold": any(nozzle.hold > 0 for nozzle in self.inflow),
        }
        if wanted := [name for name, here in only.items() if here]:
            raise ValueError(f"{', '.join(wanted)}: only with solver.pressure = dfsph, isph or hybrid, not {self.solver.pressure}")

    @property
    def incompressible(self):
        """Whether the liquid is one of `melt.scene.slime`."""
        return self.solver.pressure in INCOMPRESSIBLE

    @property
    def system(self):
        """Which of the systems it is: melting, boiling (position based liquids, too) or slime; floods have models of their own."""
        return SYSTEM_OF[self.solver.pressure]

    @property
    def particle_volume(self):
        """Volume of a particle at rest [m^3]; in two dimensions of a metre of depth."""
        return self.domain.spacing**self.domain.dimensions

    @property
    def spacing(self):
        """Particle spacing dx [m]."""
        return self.domain.spacing

    @property
    def support(self):
        """Support radius h of the smoothing function [m]."""
        return self.solver.support * self.domain.spacing

    def to_toml(self):
        """Return the scene as TOML text that loads to an equal scene."""
        from melt.scene.toml import dumps

        return dumps(self.model_dump(exclude_none=True))
