"""Scene -> the parameter tuples of `melt.params`, cast to the run's precision. Spec 2."""

import math

import numpy as np

from melt import params as P
from melt.errors import InputError

KERNELS = {"cubic": P.CUBIC, "wendland2": P.WENDLAND2, "mueller": P.MUELLER}
LAPLACIANS = {"visc": P.L_VISC, "brook": P.L_BROOK, "brook_regular": P.L_BROOK_REGULAR}
VOLUMES = {"rest": P.VOLUME_REST, "akinci": P.VOLUME_AKINCI, "shell": P.VOLUME_SHELL}
ROTATIONS = {"svd": P.ROTATION_SVD, "horn": P.ROTATION_HORN, "iterative": P.ROTATION_ITERATIVE}
REFILLS = {"all": P.REFILL_ALL, "changed": P.REFILL_CHANGED, "affected": P.REFILL_AFFECTED}


def lattice_offsets(ratio, dimensions=3):
    """Return the distances, in spacings, of the lattice points within ``ratio`` spacings, itself excluded."""
    reach = math.ceil(ratio)
    axis = np.arange(-reach, reach + 1)
    r = np.sqrt((np.stack(np.meshgrid(axis, axis, axis if dimensions == 3 else [0])) ** 2).sum(axis=0)).ravel()
    return np.sort(r[(r > 0) & (r < ratio)])


def list_capacity(ratio):
    """Return the slots of a neighbour list to begin with: 1.4 times the particles at rest in a support of ``ratio`` spacings.

    In whole cache lines of 16 numbers. Longest list of a developed dam break: 44 at ratio 2 (48 slots), 86 at 2.5 (96).
    Slots that stay empty are not free, as the processor fetches rows ahead only if they are close: at ratio 2 a step of
    the position based fluid takes 0.73 to 0.83 of the time that it takes with 128 slots (61,440 particles, CPU, one thread).
    """
    return 16 * math.ceil(1.4 * 4 / 3 * math.pi * ratio**3 / 16)


def tight_capacity(ratio, dimensions=3):
    """Return the slots of a list of an incompressible liquid to begin with: 1.15 times the particles at rest in a support.

    Its density stays at rest density, and its solvers read gradients of a list some forty times a step: they wait for memory,
    most of it slots that the processor fetches ahead in vain. Longest list of a developed dam break: 40 at ratio 2. Measured
    there at 59,319 particles on one thread: 4.0, 3.3 and 2.7 ms for `pressure_acceleration` with 48, 40 and 32 slots.
    """
    room = math.pi * ratio**2 if dimensions == 2 else 4 / 3 * math.pi * ratio**3
    return 8 * math.ceil(1.15 * room / 8)


def surface_share(ratio):
    """Return k_A of A = k_A dx^2 (1 - N/N_full) that gives a particle of a flat face the area dx^2 (8/3 at 2.5)."""
    reach = math.ceil(ratio)
    x, y, z = np.indices((2 * reach + 1,) * 3) - reach
    inside = (x**2 + y**2 + z**2 > 0) & (x**2 + y**2 + z**2 < ratio**2)
    return inside.sum() / (inside & (z > 0)).sum()


def lattice_density(scene):
    """Return Sum V W on the rest lattice, itself included (0.9985 for the paper's choice)."""
    from melt.physics.smoothing import W

    smoothing = smoothing_of(scene, np.float64)
    dx = scene.spacing
    total = W(0.0, smoothing) + sum(W(r * dx, smoothing) for r in lattice_offsets(scene.solver.support, scene.domain.dimensions))
    return scene.particle_volume * total


def calibration(scene):
    """Return what volumes of incompressible liquids are divided by, so that the rest lattice has the rest density."""
    return lattice_density(scene) if scene.incompressible else 1.0


def smoothing_of(scene, real):
    """Return the `Smoothing` tuple of a scene."""
    return P.make(
        P.Smoothing,
        real,
        support=scene.support,
        kernel=KERNELS[scene.solver.kernel],
        laplacian=LAPLACIANS[scene.solver.laplacian],
        dimension=scene.domain.dimensions,
    )


def density_factor(scene):
    """Return the calibration factor of the density (1 if the lattice is within 0.5 % or it is off)."""
    wanted = scene.solver.calibrate_mass
    lattice = lattice_density(scene)
    if wanted is True or (wanted == "auto" and abs(lattice - 1) > 0.005):
        return 1.0 / lattice
    return 1.0


def grid_of(scene, particles, real):
    """Return the `Grid` tuple: cells a hair larger than the support, over the domain and its walls.

    Particles beyond it are clamped into its outer cells, which keeps neighbours neighbours. A domain that
    is huge for its particles gets larger cells, at most 8 per particle.
    """
    margin = (scene.domain.walls.layers + 1) * scene.spacing
    lower = [a - margin for a in scene.domain.lower]
    extent = [b + margin - a for a, b in zip(lower, scene.domain.upper)]
    # float32 rounds a cell index by about 1e-7 of the cells along an axis: the hair must exceed that
    hair = max(1e-5, 3e-7 * max(extent) / scene.support)
    edge = scene.support * (1 + hair)
    most = max(4096, 8 * particles)
    while math.prod(math.ceil(e / edge) for e in extent) > most:
        edge *= 1.26
    for k in (k for k in range(3) if "xyz"[k] in scene.domain.periodic):  # whole cells along the first periodic axis
        length = scene.domain.upper[k] - scene.domain.lower[k]
        edge = length / max(1, math.floor(length / edge * (1 + 1e-9)))
        break
    cells = [math.ceil(e / edge) for e in extent]
    for k in range(3):  # a periodic axis has no margin, and its last cell is the larger one: all of the support is in the next
        if "xyz"[k] in scene.domain.periodic:
            lower[k] = scene.domain.lower[k]
            cells[k] = max(1, math.floor((scene.domain.upper[k] - lower[k]) / edge * (1 + 1e-6)))
    if scene.domain.dimensions == 2:  # one cell about the plane: what asks how far a cell is from a particle must find it inside
        lower[1], cells[1] = -edge / 2, 1
    return P.make(
        P.Grid,
        real,
        origin_x=lower[0],
        origin_y=lower[1],
        origin_z=lower[2],
        inverse_cell=1.0 / edge,
        nx=cells[0],
        ny=cells[1],
        nz=cells[2],
    )


def lost_box(scene):
    """Return (lower, upper) of the box outside of which particles count as lost."""
    margin = (scene.domain.walls.layers + 1) * scene.spacing + scene.support
    lower = [a - margin for a in scene.domain.lower]
    upper = [b + margin for b in scene.domain.upper]
    upper[2] += scene.domain.upper[2] - scene.domain.lower[2]  # splashes rise and come back
    return lower, upper


def params_of(scene, particles, sound_speed, real):
    """Return {registry name: tuple or scalar} for every stage of the scene."""
    s, dx = scene.solver, scene.spacing
    lower, upper = lost_box(scene)
    tuples = {
        "smoothing": smoothing_of(scene, real),
        "grid": grid_of(scene, particles, real),
        "fluid": fluid_of(scene, sound_speed, real),
        "guard": P.make(P.Guard, real, distance=s.guard_distance * dx),
        "contact": P.make(
            P.Contact,
            real,
            distance=s.contact_distance * dx,
            stiffness=s.contact_stiffness,
            damping=s.contact_damping,
            friction=s.contact_friction,
            connect=s.connect,
        ),
        "lattice": lattice_of(scene, real),
        "domain": P.make(
            P.Domain,
            real,
            lower_x=lower[0],
            lower_y=lower[1],
            lower_z=lower[2],
            upper_x=upper[0],
            upper_y=upper[1],
            upper_z=upper[2],
            delete=int(scene.domain.leave == "delete"),
        ),
        "full_neighbours": real(lattice_offsets(s.support).size),
        "smallest": np.int32(s.crumb),
    }
    if scene.heat is not None:
        tuples["heat"], tuples["change"] = heat_of(scene, real), change_of(scene, real)
    if not dx / scene.time.dt / scene.time.dt <= float(np.finfo(real).max):
        raise InputError(
            f"time.dt = {scene.time.dt:g} s is too small for {np.dtype(real).name}: raise it, or set solver.precision = 'double'"
        )
    for kind, constants in tuples.items():
        for name, value in getattr(constants, "_asdict", dict)().items():
            if not np.isfinite(value):
                raise InputError(
                    f"{kind}.{name} = {value} is not finite in {np.dtype(real).name}: a number of the scene is too large; "
                    "lower it, or set solver.precision = 'double'"
                )
    return tuples


def fluid_of(scene, sound_speed, real):
    """Return the `Fluid` tuple of a scene."""
    s, f = scene.solver, scene.fluid
    return P.make(
        P.Fluid,
        real,
        sound_speed=sound_speed,
        viscosity=P.LAMINAR if f.viscosity == "laminar" else P.ARTIFICIAL,
        alpha=f.alpha,
        mu=f.mu,
        solid_friction=f.alpha if f.solid_friction is None else f.solid_friction,
        wall_friction=f.alpha if f.wall_friction is None else f.wall_friction,
        mirror=s.mirror,
        clamp=int(f.clamp),
        density_factor=density_factor(scene),
        minimum_volume=scene.particle_volume / calibration(scene),
        number_density=int(s.density_form == "number"),
        central=f.central,
        gravity_x=scene.domain.gravity[0],
        gravity_y=scene.domain.gravity[1],
        gravity_z=scene.domain.gravity[2],
        expansion=f.expansion,
        drag=f.drag,
        xsph=f.xsph,
        surface_tension=f.surface_tension,
        reference_temperature=f.temperature if f.reference_temperature is None else f.reference_temperature,
    )


def lattice_of(scene, real):
    """Return the `Lattice` tuple of a scene."""
    s = scene.solver
    wide = real is np.float64
    iterations = (60 if wide else 25) if s.rotation_iterations == "auto" else s.rotation_iterations
    tolerance = (1e-14 if wide else 1e-7) if s.rotation_tolerance is None else s.rotation_tolerance
    return P.make(
        P.Lattice,
        real,
        width=s.width,
        spacing=scene.spacing,
        solid_volume=VOLUMES[s.solid_volume],
        solid_scale=s.solid_scale,
        rotation=ROTATIONS[s.rotation],
        iterations=iterations,
        tolerance=tolerance,
        stiffness=s.stiffness,
        damping=s.damping,
        refill=REFILLS[s.refill],
        connect=s.connect,
    )


def heat_of(scene, real):
    """Return the `Heat` tuple of a scene."""
    h = scene.heat
    return P.make(
        P.Heat,
        real,
        law=P.HEAT_PAPER if h.law == "paper" else P.HEAT_PHYSICAL,
        current_volume=int(h.volume == "current"),
        full_sweep=int(h.sweep_dt == "full"),
        latent=int(h.latent),
        ambient_transfer=h.ambient_transfer,
        ambient_temperature=0.0 if h.ambient_temperature is None else h.ambient_temperature,
        full_neighbours=float(lattice_offsets(scene.solver.support).size),
        spacing=scene.spacing,
        ambient_area=surface_share(scene.solver.support),
        wall_fixed=int(h.wall_temperature is not None),
    )


def change_of(scene, real):
    """Return the `Change` tuple of a scene."""
    h = scene.heat
    return P.make(
        P.Change,
        real,
        own_liquid=int(scene.solver.melt_to == "own"),
        latent=int(h.latent),
        hysteresis=h.hysteresis,
        reach=0.6 * scene.spacing,
    )


def sound_speed_of(scene, liquid_depth, fall):
    """Return (c_s [m/s], warning or ""): "auto", "legal" or as given. Spec 2.3, 2.6.

    ``liquid_depth`` [m] is the height of the liquid at the start; ``fall`` [m] the drop of an inflow.
    "auto" allows 1 % compression at the reference speed, and is lowered (with a warning) when the
    sub-steps that it needs would exceed ``time.n_sub_max``.
    """
    f, t = scene.fluid, scene.time
    h_s = 0.5 * scene.support

    def legal(n_sub):
        return 0.4 * h_s * n_sub / (t.dt * (1 + 0.6 * f.alpha))

    if f.sound_speed == "legal":
        return legal(t.n_sub), ""
    if f.sound_speed != "auto":
        return f.sound_speed, ""
    g = math.hypot(*scene.domain.gravity)
    speeds = [math.sqrt(2 * g * max(liquid_depth, scene.spacing)), f.reference_speed or 0.0]
    speeds += [math.sqrt(nozzle.speed**2 + 2 * g * fall) for nozzle in scene.inflow]
    wanted = max(*speeds, 1e-6) / math.sqrt(f.compression)
    most = legal(t.n_sub_max)
    if t.n_sub == "auto" and wanted > most:
        return most, (
            f"the sound speed was lowered from {wanted:.3g} to {most:.3g} m/s, what time.n_sub_max = {t.n_sub_max} "
            f"sub-steps of dt = {t.dt:g} s allow: compression rises to {1e2 * (max(speeds) / most) * (max(speeds) / most):.3g} %. "
            "Lower time.dt or raise time.n_sub_max"
        )
    return wanted, ""
