"""Scene -> what boiling needs: parameter tuples, initial arrays, slots for bubbles. Boiling spec 2.3-2.6, 3."""

import math
from typing import NamedTuple

import numpy as np

from melt import params as P

ALWAYS = 1 << 30  # threshold that every draw passes
FAR = 1e30  # where there is no wall
BOOSTS = {
    "off": P.BOOST_OFF,
    "rate": P.BOOST_RATE,
    "literal": P.BOOST_LITERAL,
    "boussinesq": P.BOOST_BOUSSINESQ,
    "viscosity": P.BOOST_VISCOSITY,
}
MASS_MODELS = {"cargo": P.MASS_CARGO, "nucleate": P.MASS_NUCLEATE, "recycle": P.MASS_RECYCLE}
FRAME = 1 / 60  # s, the paper's step of alpha and kappa


class Liquid(NamedTuple):
    """What boiling asks of the liquid as it stands at the start."""

    particles: int
    depth: float  # height above the floor [m]
    cells: tuple  # of the box that it fills, in spacings
    corner: tuple  # lower corner of that box [m]


def liquid_of(scene, initial):
    """Return the `Liquid` of a scene at its start."""
    x = initial["position"][:, initial["phase"] == 0]
    d = scene.spacing
    if not x.size:
        return Liquid(0, d, (1, 1, 1), tuple(scene.domain.lower))
    lower, upper = x.min(axis=1) - d / 2, x.max(axis=1) + d / 2
    cells = tuple(int(c) for c in np.rint((upper - lower) / d))
    return Liquid(x.shape[1], float(upper[2] - scene.domain.lower[2]), cells, tuple(lower))


def slots_of(scene, particles):
    """Return (bubbles, vapour): slots kept for them, given the liquid particles."""
    b = scene.boiling
    if b is None:
        return 0, 0
    bubbles = 2 * particles if b.bubbles.capacity is None else b.bubbles.capacity
    vapour = 0
    if b.vapour is not None:
        vapour = particles if b.vapour.capacity is None else b.vapour.capacity
    return max(4, bubbles), vapour


def gravity_of(scene):
    """Return g [m/s^2] and the unit vector that points up."""
    vector = np.array(scene.domain.gravity, float)
    size = float(np.linalg.norm(vector))
    return size, -vector / size if size > 0 else np.array([0.0, 0.0, 1.0])


def diffusivity_of(scene):
    """Return alpha [m^2/s]: the scene's, or the paper's number of 0.1 spacing^2 per frame."""
    given = scene.boiling.diffusivity
    return 0.1 * scene.spacing**2 / FRAME if given is None else given


def heater_box(scene):
    """Return (lower, upper) of the heated rectangle (x, y), cut to the floor; None if nothing is heated."""
    heater, domain = scene.boiling.heater, scene.domain
    if heater is None:
        return None
    low = np.array(domain.lower[:2], float)
    size = np.array(domain.cells[:2]) * domain.spacing
    centre = low + size / 2 if heater.centre is None else np.array(heater.centre)
    half = 0.2 * size if heater.half_size is None else np.array(heater.half_size)
    lower, upper = np.maximum(centre - half, low), np.minimum(centre + half, low + size)
    return (lower, upper) if np.all(upper > lower) else None


def _word(value):
    """Return the int32 that has the bits of a word below 2^32."""
    return int(np.uint32(value & 0xFFFFFFFF).astype(np.int32))


def threshold_of(dt, waiting):
    """Return the share of 2^30 that a nucleation draw of a step dt must be below, 1 - exp(-dt/waiting)."""
    return ALWAYS if waiting <= 0 else int(-math.expm1(-dt / waiting) * ALWAYS)


def boiling_of(scene, real, dt):
    """Return the `Boiling` tuple; ``dt`` [s] is the sub-step that the threshold of nucleation is for."""
    b, d = scene.boiling, scene.spacing
    box = heater_box(scene)
    lower, upper = ((0.0, 0.0), (-1.0, -1.0)) if box is None else box
    return P.make(
        P.Boiling,
        real,
        diffusivity=diffusivity_of(scene),
        corrected=int(b.heat_model != "particle10"),
        specific_heat=b.specific_heat,
        boiling_point=b.boiling_point,
        latent_heat=b.latent_scale * b.latent_heat if b.heat_model != "grid" else 0.0,
        start_temperature=scene.fluid.temperature,
        threshold=threshold_of(dt, b.nucleation_time),
        seed_low=_word(b.seed),
        seed_high=_word(b.seed >> 32),
        mass_model=MASS_MODELS[b.mass_model],
        subcooling=b.subcooling,
        heater_lower_x=lower[0],
        heater_upper_x=upper[0],
        heater_lower_y=lower[1],
        heater_upper_y=upper[1],
        contact=d,
        boost=BOOSTS[b.boost],
        boost_rate=b.boost_rate,
        boost_speed=b.boost_speed,
        expansion=b.expansion,
    )


def _walls(scene):
    """Return the box of the walls as the last entries of `Bubbles`: FAR away where there is none."""
    domain = scene.domain
    lower = np.array(domain.lower, float)
    upper = lower + np.array(domain.cells) * domain.spacing
    sides = {}
    for k, axis in enumerate("xyz"):
        sides[f"lower_{axis}"] = lower[k] if f"{axis}-" in domain.walls.sides else -FAR
        sides[f"upper_{axis}"] = upper[k] if f"{axis}+" in domain.walls.sides else FAR
    return sides


def birth_radius(spacing):
    """Return the radius of the four bubbles that have the volume of one particle [m]."""
    return (3 / (16 * math.pi)) ** (1 / 3) * spacing


def bubbles_of(scene, liquid, real):
    """Return the `Bubbles` tuple. Spec 2.5."""
    b, d, R, rho = scene.boiling.bubbles, scene.spacing, scene.support, scene.fluid.density
    inertia = b.gas_density + b.added_mass * rho
    g, up = gravity_of(scene)
    rise = g * (rho - b.gas_density) / inertia * up
    r_b0 = birth_radius(d)
    normalised = b.drift_form == "normalised"
    return P.make(
        P.Bubbles,
        real,
        spacing=d,
        birth_radius=r_b0,
        birth_reach=d,
        inertia=inertia,
        rise_x=rise[0],
        rise_y=rise[1],
        rise_z=rise[2],
        drag=3 / 8 * b.drag * rho / inertia,
        literal_radius=int(b.radius_law == "paper"),
        growth=b.beta / b.alpha,
        radius_height=b.alpha,
        radius_rate=b.beta,
        depth=liquid.depth,
        growth_time=liquid.depth / math.sqrt(max(g, 1e-12) * r_b0),
        largest=2 * R,
        most_volume=4.2 * d**3,
        merge_age=b.merge_age,
        plain_mean=int(b.merge_position == "mean"),
        upward=int(b.merge_velocity == "up"),
        drift=b.drift * (R if normalised else d) / FRAME,
        normalised=int(normalised),
        burst_radius=b.burst_radius * d,
        push_reach=b.push_reach * R,
        push_side=b.push_side / b.push_time,
        push_up=b.push_up / b.push_time,
        push_even=int(b.push_weight == "even"),
        floor=scene.domain.lower[2],
        **_walls(scene),
    )


def vapour_of(scene, real):
    """Return the `Vapour` tuple: particles of the volume of a liquid one, of the gas's density. Spec 2.6."""
    v, d = scene.boiling.vapour, scene.spacing
    rho = scene.boiling.bubbles.gas_density
    g, up = gravity_of(scene)
    lift = g * v.expansion * up
    return P.make(
        P.Vapour,
        real,
        support=scene.support,
        minimum_support=v.minimum_support * scene.support,
        mass=rho * d**3,
        rest_density=rho,
        stiffness=v.stiffness,
        buoyancy_x=lift[0],
        buoyancy_y=lift[1],
        buoyancy_z=lift[2],
        air_temperature=scene.boiling.air_temperature,
        drag=v.drag,
        life=v.life,
        density_share=v.density_share,
        adapt=int(v.precision),
        per_burst=v.per_burst,
        spread=d,
    )


def condensate_of(scene, real):
    """Return the `Condensate` tuple: a particle as at the start, but at the air's temperature. Spec 3."""
    d, domain = scene.spacing, scene.domain
    return P.make(
        P.Condensate,
        real,
        lower_x=domain.lower[0] + d / 2,
        lower_y=domain.lower[1] + d / 2,
        width_x=(domain.cells[0] - 1) * d,
        width_y=(domain.cells[1] - 1) * d,
        mass=scene.fluid.density * d**3,
        volume=d**3,
        temperature=scene.boiling.air_temperature,
    )


def tank_of(scene, liquid, real):
    """Return the `Tank` tuple: the temperature grid over the liquid as it stands at the start. Eq (9)."""
    d = scene.spacing
    return P.make(
        P.Tank,
        real,
        origin_x=liquid.corner[0],
        origin_y=liquid.corner[1],
        origin_z=liquid.corner[2],
        inverse_cell=1 / d,
        nx=liquid.cells[0],
        ny=liquid.cells[1],
        nz=liquid.cells[2],
        number=diffusivity_of(scene) / d**2,
        capacity=scene.fluid.density * scene.boiling.specific_heat * d**3,
    )


def sph_sound_speed(scene, depth):
    """Return c_s [m/s]: the scene's, or the one that compresses the bottom of the liquid by the tolerance."""
    given = scene.solver.sph.sound_speed
    if given != "auto":
        return given
    return math.sqrt(gravity_of(scene)[0] * max(depth, scene.spacing) / scene.solver.pbf.compression)


def sph_of(scene, depth, real):
    """Return the `Sph` tuple. Spec 1."""
    rho = scene.fluid.density
    return P.make(
        P.Sph,
        real,
        support=scene.support,
        rest_density=rho,
        stiffness=rho * sph_sound_speed(scene, depth) ** 2,
        viscosity=scene.solver.sph.viscosity,
    )


def boiling_fields(scene, liquid):
    """Return the initial arrays of a liquid that has not boiled yet, those that are not 0."""
    return {"voxel_temperature": np.full(math.prod(liquid.cells), scene.fluid.temperature)}
