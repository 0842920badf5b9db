"""Scene -> what the incompressible step page needs: its needs, settings, parameter tuples and sizes. Slime spec 1, 2, 4."""

import math

import numpy as np

from melt import params as P
from melt.constants import KERNELS, calibration, grid_of, lattice_offsets, smoothing_of
from melt.errors import InputError
from melt.physics.smoothing import dW
from melt.slime.motion import Body

LAWS = {"constant": P.VISCOSITY_CONSTANT, "arrhenius": P.VISCOSITY_ARRHENIUS, "exponential": P.VISCOSITY_EXPONENTIAL}
AXES = "xyz"
FULL = 0.9  # share of the lattice's neighbours below which a liquid without ghosts borders on air
MOST = 2  # rest volumes that a node counts for at most: beyond 3 in the plane it is as dense as liquid by itself
RELAX = 10  # passes at most that take the overlap out of a start
MOST_GHOST_POINTS = 200_000_000
#: Arguments of stages that serve scenes with and without: left out (length 0) unless the scene needs them.
ONLY_IF = {
    "apic": ("apic_phase", "apic_affine"),
    "ghosts": ("ghost_laplacian",),
    "augmented": ("dilation", "viscous_pressure"),
    "tension": ("surface_pressure",),
    "shears": ("shear_rate",),
    "elastic": ("apic_strain",),
    "impulses": ("density_impulse", "divergence_impulse"),
    "poisson": ("poisson_pressure",),
    "viscosity": ("viscous_pressure",),
}


def needs_of(scene):
    """Return {what the page asks for: bool}; of a liquid that is not incompressible all are False."""
    s, v = scene.solver, scene.viscosity
    return dict(
        dfsph=s.pressure in ("dfsph", "hybrid"),
        poisson=s.pressure in ("isph", "hybrid"),
        apic=s.apic is not None,
        ghosts=s.ghosts is not None,
        semi_lagrangian=s.dfsph.semi_lagrangian,
        viscosity=v is not None and v.mu > 0,
        augmented=v is not None and v.mu > 0 and needs_augmented(scene),
        shears=v is not None and v.shears,
        elastic=scene.elastic is not None,
        drivers=any(o.moves for o in scene.obstacle),
        loads=any(o.force for o in scene.obstacle),
        nozzles=any(nozzle.hold > 0 for nozzle in scene.inflow),
        periodic=bool(scene.domain.periodic),
        impulses=scene.incompressible and (s.pressure != "isph" or relaxes(scene)),
        closed=closed(scene),
        shift=s.dfsph.shift > 0,
        tension=scene.fluid.sigma > 0,
    )


def relaxes(scene):
    """Return whether the start of a scene may overlap, so that the density solve moves it apart."""
    return scene.fluid.jitter > 0 or scene.solver.apic is not None


def closed(scene):
    """Return whether there is no free surface, so that pressure is known but for a constant: all axes are periodic, or walls enclose it."""
    return scene.fluid.enclosed or len(scene.domain.periodic) == scene.domain.dimensions


def stokes_of(scene):
    """Return "al" or "split": "auto" couples viscosity and pressure where the step is long for viscosity."""
    v = scene.viscosity
    if v.stokes != "auto":
        return v.stokes
    return "al" if v.mu * scene.time.dt / (scene.fluid.density * scene.support**2) > 0.1 else "split"


def settings_of(scene, initial):
    """Return the run-time choices of the page."""
    q, v, g = scene.solver.dfsph, scene.viscosity, np.linalg.norm(scene.domain.gravity)
    chosen = dict(
        spacing=scene.spacing,
        courant=q.courant,
        density_tolerance=q.density_tolerance,
        divergence_tolerance=q.divergence_tolerance,
        max_iterations=q.max_iterations,
        accelerate=q.accelerate,
        early_divergence=q.order == "bk",
        poisson_tolerance=q.poisson_tolerance,
        poisson_iterations=q.poisson_iterations,
        on_fail=q.on_fail,
        retries=q.retries,
        arrivals=q.arrivals if q.semi_lagrangian else 1,
        gravity=float(g),
        shift=q.shift * scene.support**2,
        density=scene.fluid.density,
        bodies=[Body.of(o, k) for k, o in enumerate(o for o in scene.obstacle if o.moves)],
        measured=_measured(scene),
        apic_per_node=1 if scene.solver.apic is None else scene.solver.apic.per_axis**scene.domain.dimensions,
        node_volume=scene.particle_volume,
        sigma=scene.fluid.sigma,
        capillary=2 * math.pi * scene.fluid.sigma / (scene.fluid.density * scene.spacing**3),
        elastic_speed=0.0 if scene.elastic is None else math.sqrt(scene.elastic.modulus / scene.fluid.density),
        flow=scene.fluid.flow,
        design_speed=initial.top_speed,
        relax=RELAX if relaxes(scene) else 0,
    )
    if v is not None:
        chosen.update(
            outer=v.outer,
            viscous_tolerance=v.tolerance,
            viscous_iterations=v.max_iterations,
        )
    return chosen


def _measured(scene):
    """Return (number of the body, name) of each whose force is measured; one without a name goes by its place in the scene."""
    moving = [(o, o.name or f"obstacle {place}") for place, o in enumerate(scene.obstacle) if o.moves]
    return [(number, name) for number, (o, name) in enumerate(moving) if o.force]


def params_of(scene, particles, real):
    """Return {registry name: tuple} of an incompressible scene."""
    s, d, dim, h = scene.solver, scene.spacing, scene.domain.dimensions, scene.support
    tuples = {
        "period": period_of(scene, real),
        "dfsph": P.make(
            P.Dfsph,
            real,
            omega=s.dfsph.omega,
            warm=s.dfsph.warm_start,
            warm_limit=10.0,
            fewest=7 if dim == 2 else 20,
            least=1e-6 / h**2,
        ),
        "poisson": P.make(
            P.Poisson,
            real,
            rest_density=scene.fluid.density,
            floor=1e-4 * h**2,
            pull=s.dfsph.pull,
            full_share=0.0 if closed(scene) else 0.85,
            clamp=int(s.dfsph.clamp),
            full=0.0 if closed(scene) else FULL * lattice_laplacian(scene),
        ),
    }
    if s.ghosts is not None:
        tuples["ghosts"] = ghosts_of(scene, grid_of(scene, particles, np.float64), real)
    if s.apic is not None:
        tuples["apic"] = P.make(
            P.Apic,
            real,
            support=s.apic.support * h,
            kernel=KERNELS[s.kernel],
            dimension=dim,
            affine=int(s.apic.affine),
            literal=int(s.apic.position_rule == "literal"),
            flip=s.apic.flip,
            rank=1e-2 * (s.apic.support * h) ** 2,
            orphan=1e-3 * (40 / (7 * math.pi) if dim == 2 else 8 / math.pi) / (s.apic.support * h) ** dim,
            massless=1e-12 * scene.fluid.density * d**dim,
            most=MOST * d**dim,
            rest_density=scene.fluid.density * calibration(scene),
        )
    if scene.viscosity is not None:
        tuples["viscous"] = viscous_of(scene, real)
    if scene.elastic is not None:
        tuples["elastic"] = P.make(P.Elastic, real, modulus=scene.elastic.modulus, relaxation=scene.elastic.relaxation, dimension=dim)
    return tuples


def lattice_laplacian(scene):
    """Return the sum of V F over the rest lattice [1/m^2], F = -W'/r."""
    smoothing, d = smoothing_of(scene, np.float64), scene.spacing
    r = d * lattice_offsets(scene.solver.support, scene.domain.dimensions)
    return scene.particle_volume * -sum(dW(q, smoothing) / q for q in r)


def period_of(scene, real):
    """Return the `Period` tuple."""
    values = {}
    for k, axis in enumerate(AXES):
        length = scene.domain.upper[k] - scene.domain.lower[k] if axis in scene.domain.periodic else 0.0
        values.update({f"length_{axis}": length, f"inverse_{axis}": 1 / length if length else 0.0, f"lower_{axis}": scene.domain.lower[k]})
    return P.make(P.Period, real, **values)


def viscous_of(scene, real):
    """Return the `Viscous` tuple."""
    v, dim = scene.viscosity, scene.domain.dimensions
    return P.make(
        P.Viscous,
        real,
        law=LAWS[v.law],
        mu=v.mu,
        slope=v.activation_temperature if v.law == "arrhenius" else v.rate,
        reference_temperature=v.reference_temperature,
        power=v.index,
        yield_stress=v.yield_stress,
        yield_rate=v.yield_time,
        smallest=v.smallest,
        largest=v.largest,
        wall=2 * v.wall,  # mirrored velocity at a flat wall, in the mean: without it water slips by half a spacing
        strength=2 * (dim + 2),
        floor=v.floor * scene.support**2,
        gamma=v.gamma if needs_augmented(scene) else 0.0,
    )


def needs_augmented(scene):
    """Return whether viscosity and incompressibility are solved together."""
    return scene.viscosity.gamma > 0 and scene.viscosity.outer > 0 and stokes_of(scene) == "al"


def ghosts_of(scene, grid, real):
    """Return the `Ghosts` tuple; ``grid`` in float64."""
    q, d, flat = scene.solver.ghosts, scene.spacing, scene.domain.dimensions == 2
    edge = 1 / float(grid.inverse_cell)
    across = max(1, math.ceil(2 * edge / d - 1e-6))
    points = across ** (2 if flat else 3) * float(grid.nx) * float(grid.ny) * float(grid.nz)
    if points > MOST_GHOST_POINTS:
        raise InputError(
            f"solver.ghosts: the domain has {points:.3g} places for ghosts, more than {MOST_GHOST_POINTS:,}: make the domain smaller, "
            "raise domain.spacing, or leave [solver.ghosts] out"
        )
    distance = (0.8 if flat else 0.85) if q.distance is None else q.distance
    seed = np.array([q.seed & 0xFFFFFFFF, q.seed >> 32 & 0xFFFFFFFF], np.uint32).view(np.int32)
    return P.make(
        P.Ghosts,
        real,
        across=across,
        flat=int(flat),
        pitch=edge / across,
        distance=distance * d,
        jitter=q.jitter * d,
        fill=q.fill,
        volume=scene.particle_volume,
        plane=0.0,
        seed_low=int(seed[0]),
        seed_high=int(seed[1]),
    )


def sizes_of(scene, initial, params):
    """Return the sizes of the extents that only these scenes have."""
    grid = params["grid"]
    cells = int(grid.nx) * int(grid.ny) * int(grid.nz)
    per_cell = int(params["ghosts"].across) ** (2 if scene.domain.dimensions == 2 else 3) if "ghosts" in params else 0
    return {
        "apic": initial["apic_id"].size if "apic_id" in initial else 0,
        "ghost": 1024 if per_cell else 0,
        "ghost_point": cells * per_cell,
        "driver": sum(o.moves for o in scene.obstacle),
        "nozzle": len(scene.inflow),
        "offset": initial["apic_offset"].shape[1] if "apic_offset" in initial else 0,
    }
