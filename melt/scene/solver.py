"""Numerical choices of a scene, each a knob of the speed-accuracy trade."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from melt.scene.quantities import (
    Count,
    DynamicViscosity,
    NonNegative,
    Positive,
    PositiveCount,
    PositiveSpeed,
    Section,
    Share,
    quantity,
)
from melt.scene.slime import INCOMPRESSIBLE, Apic, Ghosts, Incompressible, switched

#: Whose method a pressure solver is (`Scene.system`, presets); floods have models of their own.
SYSTEM_OF = {"wcsph": "melting", "pbf": "boiling", "sph": "boiling"} | dict.fromkeys(INCOMPRESSIBLE, "slime")

Width = Annotated[int, Field(ge=0, le=5)]


class PositionBased(Section):
    """Numbers of the position based fluid (solver.pressure = pbf)."""

    iterations: Annotated[int, Field(ge=1, le=255)] = 4
    """Iterations J of the density solve per sub-step."""
    omega: Positive = 1.0
    """Relaxation; the solve diverges if omega/(1 + eps_rel) times the largest eigenvalue of the lattice exceeds 2."""
    eps_rel: NonNegative = 1.0
    """Softening of the constraint in units of a particle's own denominator."""
    one_sided: bool = False
    """Only push apart: without this, liquid also holds together where it is too thin."""
    push: NonNegative = 0.03
    """Artificial pressure k_s: 0.1 pushes as a density error of 10 % does at the distance push_distance.

    0.1, the usual value, makes liquid much more viscous (a dam-break front runs 3.7 column widths instead of 4.4, a
    weakly compressible one 4.5); at 0.01 a Taylor-Green flow gains energy.
    """
    push_distance: Annotated[quantity("number", above=0, at_most=0.9), Field()] = 0.2
    """Distance of it in support radii."""
    xsph: NonNegative = 12.0
    """Rate gamma of XSPH viscosity [1/s]."""
    vorticity: NonNegative = 0.0
    """Strength eps_v of vorticity confinement [m/s]; it adds momentum."""
    compression: Annotated[quantity("number", above=0, at_most=0.5), Field()] = 0.025
    """Compression at the bottom of the resting liquid that the automatic sub-steps allow."""
    precision: bool = False
    """Effect precision: particles far from the surface and slow ones get a smaller support and fewer iterations."""
    height_share: Share = 0.5
    """Share a_F of the height in the effect precision; the rest is the share of momentum."""
    minimum_support: Annotated[quantity("number", at_least=1.6), Field()] = 1.8
    """Smallest support radius in spacings."""
    minimum_iterations: PositiveCount = 2
    minimum_precision: Share = 0.0
    """Smallest effect precision."""
    precision_time: Positive = 0.05
    """Time constant with which the effect precision follows [s]."""


class PlainSph(Section):
    """Numbers of Mueller 2003's SPH (solver.pressure = sph), the baseline of the boiling paper."""

    sound_speed: PositiveSpeed | Literal["auto"] = "auto"
    """"auto": the bottom of the resting liquid compresses by solver.pbf.compression."""
    viscosity: DynamicViscosity = 3.0
    cfl: Positive = 0.4
    """Sub-steps of at most cfl R / sound speed."""


class Solver(Section):
    """Numerical method."""

    pressure: Literal["wcsph", "pbf", "sph", "dfsph", "isph", "hybrid"] = "wcsph"
    """"wcsph": weakly compressible SPH; "pbf": position based fluid, for liquids between walls; "sph": Mueller 2003's;
    "dfsph": divergence-free SPH; "isph": pressure Poisson equation; "hybrid": that and dfsph for what it leaves."""
    dfsph: Incompressible = Field(default_factory=Incompressible)
    apic: Annotated[Apic | None, BeforeValidator(switched)] = None
    """APIC particles: a section, or true with its defaults, or false."""
    ghosts: Annotated[Ghosts | None, BeforeValidator(switched)] = None
    """Air ghost particles: a section, or true with its defaults, or false."""
    pbf: PositionBased = Field(default_factory=PositionBased)
    sph: PlainSph = Field(default_factory=PlainSph)
    kernel: Literal["cubic", "wendland2", "mueller"] = "cubic"
    """Smoothing function W."""
    laplacian: Literal["visc", "brook", "brook_regular"] = "visc"
    """Weight of second derivatives: Mueller's viscosity kernel, Brookshaw's form, or that regularised."""
    support: Annotated[quantity("number", above=1, at_most=6), Field()] = None
    """Support radius in spacings, h/dx; 2.5, or 2.2 with pressure = pbf, 2.4 if incompressible, unless given."""
    neighbours: Literal["grid", "kdtree"] = "grid"
    max_neighbours: PositiveCount | None = None
    """Initial capacity of neighbour lists, by the support unless given; it grows when a list overflows."""
    precision: Literal["single", "mixed", "double"] = "mixed"
    """"mixed": positions and their sums in float64, pair work in float32."""
    integration: Literal["symplectic", "kdk"] = "symplectic"
    """Leap-frog variant."""
    motion: bool = True
    """False: nothing moves, only heat and phase change happen."""
    density_form: Literal["number", "volume"] = "number"
    """"number": the paper's eq (1); "volume": sums of each particle's own volume."""
    calibrate_mass: bool | Literal["auto"] = "auto"
    """Scale the density so that the rest lattice has the rest density; "auto": if it is off by over 0.5 %."""
    mirror: Share = 1.0
    """Share of the liquid's pressure that solids and walls carry; 0 is the paper's eq (2)."""
    solid_volume: Literal["rest", "akinci", "shell"] = "rest"
    """Volumes of solid particles in density sums."""
    solid_scale: Positive = 1.0
    """Factor on the volumes of solids in density sums; at 1 bodies float at their depth, in DFSPH deeper (docs/slime.md)."""
    guard: bool = True
    """Push liquid out of solids and walls that it came too close to."""
    guard_distance: Positive = 0.5
    """Distance of the guard in spacings."""
    contact: bool = True
    """Contact of solids with each other and with walls."""
    contact_distance: Positive = 1.0
    """Distance of contact in spacings."""
    contact_stiffness: NonNegative = 0.25
    """Stiffness in units of reduced mass / dt^2."""
    contact_damping: Share = 0.5
    """Share of the normal approach speed removed per sub-step."""
    contact_friction: NonNegative = 0.2
    """Coulomb coefficient."""
    baseline: Literal["none", "rigid"] = "none"
    """"rigid": each connected piece is one rigid body (reconstruction of Iwasaki et al. 2010)."""
    width: Width = 2
    """Hops w of a shape matching region."""
    stiffness: Annotated[quantity("number", at_least=0, at_most=1), Field()] = 1.0
    """Share of the way to the goal position taken per sub-step."""
    damping: Share = 0.05
    """Damping towards region-rigid motion per outer step."""
    rotation: Literal["svd", "horn", "iterative"] = "iterative"
    """Routine of the region rotation."""
    rotation_iterations: PositiveCount | Literal["auto"] = "auto"
    """Cap of "iterative": 60 in double, 25 in single and mixed precision."""
    rotation_tolerance: Positive | None = None
    """Of "iterative": 1e-14 (of the squared turn) in double, 1e-7 in single and mixed precision unless given."""
    refill: Literal["all", "changed", "affected"] = "affected"
    """Regions to fill again after melting; all three give the same regions."""
    connect: Literal[6, 18, 26] = 26
    """Voxel neighbours that bond."""
    melt_every: PositiveCount = 1
    """Outer steps between melt tests."""
    melt_to: Literal["water", "own"] = "water"
    """"water": melt becomes the ambient liquid, volume kept; "own": mass kept, V0 = m / liquid_density."""
    crumb: Count = 0
    """Pieces with fewer particles become liquid at once; 0 is off."""

    @model_validator(mode="after")
    def _fits(self):
        if self.support is None:
            self.support = {"wcsph": 2.5, "pbf": 2.2, "sph": 2.2}.get(self.pressure, 2.4)
        if self.pressure not in INCOMPRESSIBLE and (self.apic or self.ghosts):
            raise ValueError(f"[solver.apic] and [solver.ghosts] need pressure = dfsph, isph or hybrid, not {self.pressure}")
        if self.baseline == "rigid" and self.integration == "kdk":
            raise ValueError("baseline = rigid makes the forces of a sub-step rigid once: use integration = symplectic")
        if self.baseline == "rigid" and self.width == 0:
            raise ValueError("width = 0 has no regions to be rigid: set width to 1 or more")
        return self
