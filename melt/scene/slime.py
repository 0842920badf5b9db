"""Sections of incompressible and viscous liquids: solver.dfsph, solver.apic, solver.ghosts, [viscosity], [elastic]. Slime spec 4."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from melt.scene.quantities import (
    DynamicViscosity,
    NonNegative,
    Positive,
    PositiveCount,
    PositiveLength,
    PositiveTime,
    Rate,
    Section,
    Seed,
    Share,
    Temperature,
    Vector,
    quantity,
)

#: Pressure solvers of an incompressible liquid.
INCOMPRESSIBLE = ("dfsph", "isph", "hybrid")


def switched(value):
    """Return what an optional section is given as: true is the section with its defaults, false none."""
    return {} if value is True else None if value is False else value


class Incompressible(Section):
    """Numbers of the incompressible solvers (solver.pressure = dfsph, isph or hybrid)."""

    density_tolerance: Annotated[quantity("number", above=0, at_most=0.1), Field()] = 1e-4
    """Mean compression that the constant-density solve may leave."""
    divergence_tolerance: Annotated[quantity("number", above=0, at_most=0.1), Field()] = 1e-3
    """Mean compression per sub-step that the divergence-free solve may leave."""
    max_iterations: Annotated[int, Field(ge=1, le=10_000)] = 100
    """Iterations of each of the two after which it has not converged (see on_fail)."""
    accelerate: bool = True
    """Nesterov's momentum between Jacobi iterations: a third of them on a dam break; false: as published."""
    omega: Annotated[quantity("number", above=0, at_most=1), Field()] = None
    """Relaxation of the Jacobi iteration: 1/3 with accelerate, which diverges at 1/2, else 0.5, unless given."""
    warm_start: Share = 1.0
    """Share of the last step's pressure that they begin with."""
    order: Literal["late", "bk"] = "late"
    """Divergence-free solve after viscosity ("late"), or before it as Bender and Koschier have it ("bk")."""
    poisson_tolerance: Annotated[quantity("number", above=0, at_most=0.1), Field()] = 1e-4
    """Relative residual of the pressure Poisson equation (isph, hybrid)."""
    poisson_iterations: PositiveCount = 500
    pull: Annotated[quantity("number", at_least=0, at_most=0.1), Field()] = 0.02
    """Share of a density deficit that the Poisson equation asks back per sub-step; 0 for sprays."""
    clamp: bool = False
    """Cut all negative pressure, for sprays that separate; without it only where neighbours are missing."""
    shift: Annotated[quantity("number", at_least=0, at_most=0.1), Field()] = 0.0
    """Shift of particles from crowded to empty places in a sub-step, in squared support radii times the gradient of their
    number; keeps liquid without a surface (fluid.enclosed, or all axes periodic) in order where pressure is negative."""
    courant: Annotated[quantity("number", above=0, at_most=5), Field()] = None
    """Spacings that the fastest particle may move in a sub-step: 0.4, or 2 with semi_lagrangian, unless given."""
    semi_lagrangian: bool = False
    """Solve the forces of a sub-step where the particles arrive, which allows longer sub-steps."""
    arrivals: Annotated[int, Field(ge=1, le=5)] = 3
    """Times at most that the place of arrival is predicted in a sub-step."""
    on_fail: Literal["retry", "raise", "warn"] = "retry"
    """A solve that has not converged: try the sub-step again in two halves, stop the run, or mark the frame and go on."""
    retries: Annotated[int, Field(ge=0, le=6)] = 3
    """Halvings of a sub-step before the run stops."""

    @model_validator(mode="after")
    def _complete(self):
        if self.courant is None:
            self.courant = 2.0 if self.semi_lagrangian else 0.4
        if self.omega is None:
            self.omega = 1 / 3 if self.accelerate else 0.5
        return self


class Apic(Section):
    """APIC particles that carry mass, momentum and affine velocity ([solver.apic]); without it nodes do."""

    per_axis: Annotated[int, Field(ge=1, le=3)] = 2
    """APIC particles along each edge of a node's cell."""
    jitter: Annotated[quantity("number", at_least=0, at_most=0.25), Field()] = 0.05
    """Random displacement at the start in spacings."""
    support: Annotated[quantity("number", at_least=0.6, at_most=1), Field()] = 1.0
    """Radius of the transfers in support radii; less is less numerical viscosity."""
    flip: Annotated[quantity("number", at_least=0, at_most=0.99), Field()] = 0.0
    """Share of FLIP, for nearly inviscid liquids."""
    affine: bool = True
    """False: PIC, to show what it loses."""
    position_rule: Literal["increment", "literal"] = "increment"
    """"literal": positions by the patent's weighted sum, to show that they collapse."""
    seed: Seed = 0


class Ghosts(Section):
    """Air ghost particles beyond the free surface ([solver.ghosts])."""

    distance: Annotated[quantity("number", at_least=0.6, at_most=1.2), Field()] | None = None
    """Least distance from particles and each other in spacings: 0.85, or 0.8 in two dimensions, unless given."""
    jitter: Annotated[quantity("number", at_least=0, at_most=0.25), Field()] = 0.1
    """Random displacement of candidates in spacings."""
    fill: Share = 0.5
    """Liquid fill above which a place is not air."""
    seed: Seed = 0


class Viscosity(Section):
    """Implicit viscosity ([viscosity])."""

    mu: DynamicViscosity = 10.0
    """Dynamic viscosity in Pa s (not kinematic); at reference_temperature, and at a shear rate of 1/s unless index is 1."""
    law: Literal["constant", "arrhenius", "exponential"] = "constant"
    """How it falls with temperature: mu exp(E/R (1/T - 1/T0)), or mu exp(-rate (T - T0))."""
    activation_temperature: NonNegative = 0.0
    """E/R of "arrhenius" [K]."""
    rate: NonNegative = 0.0
    """Of "exponential" [1/K]."""
    reference_temperature: Temperature = 20.0
    index: Annotated[quantity("number", above=0, at_most=2), Field()] = 1.0
    """Power n of shear thinning (below 1) or thickening; 1 is Newtonian."""
    yield_stress: NonNegative = 0.0
    """Stress below which it hardly flows [Pa]."""
    yield_time: Positive = 10.0
    """Regularisation m of the yield stress [s]."""
    smallest: DynamicViscosity | None = None
    """Lower cap: mu/1000 unless given."""
    largest: DynamicViscosity | None = None
    """Upper cap: 1000 mu unless given."""
    wall: NonNegative = 1.0
    """Friction at walls in units of mu: 0 free slip, 1 no slip, more is sticky."""
    stokes: Literal["auto", "al", "split"] = "auto"
    """"al": viscosity and incompressibility together by an augmented Lagrangian, without which threads fall too fast;
    "split": one after the other; "auto": al where mu dt/(rho h^2) exceeds 0.1."""
    gamma: Annotated[quantity("number", at_least=0, at_most=30), Field()] = 10.0
    """Weight of the augmented Lagrangian in units of mu."""
    outer: Annotated[int, Field(ge=1, le=5)] = 2
    """Its outer iterations."""
    tolerance: Annotated[quantity("number", above=0, at_most=0.1), Field()] = 1e-4
    """Relative residual."""
    max_iterations: PositiveCount = 1000
    floor: Annotated[quantity("number", above=0, at_most=0.1), Field()] = 1e-4
    """Regularisation eps_v of close pairs in squared support radii."""

    @model_validator(mode="after")
    def _capped(self):
        if self.mu == 0 and self.yield_stress > 0:
            raise ValueError("yield_stress needs a viscosity beside it: give mu (the caps smallest and largest follow from it)")
        if self.smallest is None:
            self.smallest = 1e-3 * self.mu
        if self.largest is None:
            self.largest = 1e3 * self.mu
        if self.smallest > self.largest:
            raise ValueError(f"smallest = {self.smallest:g} Pa s exceeds largest = {self.largest:g} Pa s")
        return self

    @property
    def shears(self):
        """Whether it depends on the shear rate."""
        return self.index != 1 or self.yield_stress > 0


class Elastic(Section):
    """Viscoelastic stress on APIC particles, Oldroyd-B ([elastic])."""

    modulus: Annotated[quantity("pressure", above=0), Field()] = 300.0
    """Shear modulus G."""
    relaxation: PositiveTime = 0.5
    """Relaxation time; the polymer's viscosity is modulus times this."""


class Flow(Section):
    """Velocity of the liquid at the start ([fluid.flow]), added to that of the fills."""

    kind: Literal["rotation", "stretch", "taylor_green"] = "rotation"
    """About y: rigid rotation; x stretches and z shrinks; a periodic array of vortices."""
    rate: Rate = 1.0
    """Angular velocity, strain rate, or largest speed times 2 pi over the wave length."""
    centre: Vector = [0.0, 0.0, 0.0]
    length: PositiveLength = 1.0
    """Wave length of taylor_green."""


def check_incompressible(scene):
    """Refuse, in words, what the incompressible solvers cannot do.

    Raises:
        ValueError: with the remedy.
    """
    s, f = scene.solver, scene.fluid
    refused = {
        "solver.neighbours = kdtree (use grid)": s.neighbours == "kdtree",
        "fluid.xsph (use [viscosity])": f.xsph > 0,
        "solver.integration = kdk": s.integration == "kdk",
        "solver.kernel = mueller (use cubic or wendland2)": s.kernel == "mueller",
        "boiling ([boiling])": scene.boiling is not None,
        "heat.volume = current": scene.heat is not None and scene.heat.volume == "current",
        "fluid.viscosity = laminar without solids (use [viscosity])": f.viscosity == "laminar" and f.mu > 0 and not scene.solid,
    }
    if wanted := [name for name, here in refused.items() if here]:
        raise ValueError(f"solver.pressure = {s.pressure} works without {', '.join(wanted)}")
    if scene.solid:
        with_solids = {
            "[viscosity] (fluid.viscosity = laminar acts on solids, too)": scene.viscosity is not None,
            "[solver.apic]": s.apic is not None,
            "[solver.ghosts]": s.ghosts is not None,
            "solver.pressure = isph or hybrid (use dfsph)": s.pressure != "dfsph",
            "solver.dfsph.semi_lagrangian": s.dfsph.semi_lagrangian,
            "solver.dfsph.order = bk": s.dfsph.order == "bk",
            "domain.periodic": bool(scene.domain.periodic),
            "domain.dimensions = 2": scene.domain.dimensions == 2,
            "inflow.hold": any(nozzle.hold > 0 for nozzle in scene.inflow),
            "obstacles that move": any(o.moves for o in scene.obstacle),
            "fluid.jitter": f.jitter > 0,
        }
        if wanted := [name for name, here in with_solids.items() if here]:
            raise ValueError(f"scenes with solids have no {', '.join(wanted)} yet")
    elif not s.motion:
        raise ValueError("solver.motion = false is for scenes without an incompressible solver: leave solver.pressure out")
    if f.sigma > 0 and (s.pressure == "dfsph" or s.ghosts is None):
        raise ValueError("fluid.sigma is a pressure at the air ghost particles: set pressure = isph or hybrid, and add [solver.ghosts]")
    if f.sigma > 0 and f.surface_tension > 0:
        raise ValueError("fluid.sigma and fluid.surface_tension are two models of one thing: give one of them")
    if f.enclosed and (s.ghosts is not None or scene.inflow):
        raise ValueError("fluid.enclosed has no free surface and no room for more: leave [solver.ghosts] and [[inflow]] out, or enclosed")
    full = f.enclosed or len(scene.domain.periodic) == scene.domain.dimensions
    if s.dfsph.shift > 0 and (not full or s.apic is not None or s.dfsph.semi_lagrangian):
        raise ValueError(
            "solver.dfsph.shift moves particles to where there are fewer, which is out of a free surface: set fluid.enclosed = true "
            "if there is none, leave [solver.apic] and semi_lagrangian out, or set shift = 0"
        )
    if scene.elastic is not None and s.apic is None:
        raise ValueError("[elastic] lives on APIC particles: add [solver.apic]")
    if s.apic is not None and scene.heat is not None:
        raise ValueError(
            "[heat] needs particles of constant mass, but nodes take theirs from APIC particles in every step: leave [solver.apic] out"
        )
    if scene.viscosity is not None and scene.viscosity.law != "constant" and scene.heat is None:
        raise ValueError("viscosity.law needs temperatures: add [heat], or law = constant")
    lengths = {a: scene.domain.upper["xyz".index(a)] - scene.domain.lower["xyz".index(a)] for a in scene.domain.periodic}
    if short := [a for a, length in lengths.items() if length < 2 * scene.support * (1 + 1e-6)]:
        raise ValueError(f"domain.periodic: along {short[0]} the domain must be longer than two support radii, {2 * scene.support:g} m")
    if s.apic is not None and len(set(lengths.values())) > 1:
        raise ValueError("[solver.apic] in a domain with two periodic axes needs them to be equally long")
    if scene.heat is not None and (scene.domain.dimensions == 2 or scene.domain.periodic):
        raise ValueError("[heat] is for three dimensions without periodic sides: leave it out, or set dimensions = 3, periodic = []")
