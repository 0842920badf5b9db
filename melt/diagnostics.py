"""Ledgers of one output step: energy, mass, momentum, counts. Host side, float64."""

import numpy as np

from melt import boiling_ledger
from melt.physics.phases import INACTIVE, LIQUID, SOLID

#: Name -> (unit, meaning) of every value that `series` returns.
SERIES = {
    "kinetic_energy": ("J", "of liquids and solids, with v^(n-1/2)"),
    "potential_energy": ("J", "m g . x of liquids and solids, from the domain's origin"),
    "thermal_energy": (
        "J",
        "sum of C (T - T_m) (paper mode: of V (T - T_m), K m^3), T_m of the solid that the matter is, freezes to or "
        "(the first that) melts to it, 0 degC without one. Physical law: melting without latent heat, off or 0, keeps T "
        "and makes (c_liquid - c_solid) m (T - T_m), freezing takes it; melt_to = water changes m, too",
    ),
    "latent_energy": ("J", "latent heat stored (paper mode: K m^3)"),
    "energy_in": (
        "J",
        "heat brought since the start by heaters, ambient air and what has a fixed temperature (paper mode: K m^3). "
        "Where nothing enters or leaves, thermal_energy + latent_energy - energy_in stays, but for what phase change "
        "itself makes (see thermal_energy). Not in it: the heat of what an inflow brings and of what leave = delete takes "
        "away. With fixed temperatures it is the change of content around the solve, a balance and no check of the solver",
    ),
    "mass": ("kg", "of liquids and solids"),
    "mass_created": ("kg", "mass made (or lost, < 0) by melting into the ambient liquid since the start"),
    "mass_deleted": ("kg", "of particles that left the domain and were made inactive"),
    "momentum_x": ("kg m/s", "of liquids and solids"),
    "momentum_y": ("kg m/s", ""),
    "momentum_z": ("kg m/s", ""),
    "largest_speed": ("m/s", ""),
    "density_error_max": ("1", "largest compression of a liquid particle, rho/rho_0 - 1"),
    "density_error_mean": ("1", "mean of |rho/rho_0 - 1| over compressed liquid particles"),
    "liquid_particles": ("1", ""),
    "solid_particles": ("1", ""),
    "lost_particles": ("1", "outside of the domain and its margin, or made inactive there"),
    "coincident_particles": ("1", "liquid and solid particles at the very place of another particle"),
    "melted_fraction": ("1", "net, 1 - solids / solids at the start: below 0 where more froze than melted"),
    "melted": ("1", "particles that melted since the start; one that froze and melted again counts again"),
    "frozen": ("1", "particles that froze since the start, likewise"),
    "neighbours_mean": ("1", "over liquid particles"),
    "neighbours_max": ("1", ""),
    "guard_pairs": ("1", "liquid-solid pairs that the guard pushed apart in the last sub-step"),
    "temperature_min": ("degC", ""),
    "temperature_max": ("degC", ""),
    "temperature_mean": ("degC", "weighted with heat capacity"),
} | boiling_ledger.SERIES


def series(do, start):
    """Return the values of `SERIES` that the scene has, as {name: float}.

    ``start`` holds what is compared with: ``solids`` and ``liquids`` (numbers at the start), ``mass_entered`` [kg].
    """
    state = do.state
    order = np.argsort(state.read("id"), kind="stable")
    get = {n: state.read(n) for n in _WANTED if n in state}
    f = {n: (a[..., order] if a.shape[-1] == order.size else a) for n, a in get.items()}
    wide = {n: a.astype(np.float64) for n, a in f.items() if a.dtype.kind == "f"}
    phase = f["phase"]
    mobile = (phase == LIQUID) | (phase == SOLID)
    liquid = phase == LIQUID
    m, v, x = wide["mass"][mobile], wide["velocity"][:, mobile], wide["position"][:, mobile]
    momentum = (m * v).sum(axis=1)
    fluid = do.params["fluid"]
    g = np.array([fluid.gravity_x, fluid.gravity_y, fluid.gravity_z], dtype=np.float64)
    values = {
        "kinetic_energy": float(0.5 * (m * (v**2).sum(axis=0)).sum()),
        "potential_energy": float(-(m * (g[:, None] * x).sum(axis=0)).sum()),
        "mass": float(m.sum()),
        "momentum_x": float(momentum[0]),
        "momentum_y": float(momentum[1]),
        "momentum_z": float(momentum[2]),
        "largest_speed": float(np.sqrt((v**2).sum(axis=0).max(initial=0.0))),
        "liquid_particles": int(liquid.sum()),
        "solid_particles": int((phase == SOLID).sum()),
        "lost_particles": int(do.clock.active - (phase != INACTIVE).sum()) + outside(x, do.params["domain"]),
        "coincident_particles": coincident(wide["position"], mobile, phase != INACTIVE),
    }
    values["mass_deleted"] = float(wide["mass"][phase == INACTIVE].sum())  # slots not yet used have none
    if do.need.apic:
        values.update(_carried_by_apic(state))
    balance = values["mass"] + values["mass_deleted"]
    values["mass_created"] = balance - start["mass"] - start["mass_entered"](do.clock)
    if (measure := measure_of(wide)) and do.clock.step > 0 and liquid.any():
        error = compression(wide, liquid)
        counted = error if measure == "density_ratio" else error[error > 0]
        values["density_error_max"] = float(error.max())
        values["density_error_mean"] = float(counted.mean()) if counted.size else 0.0
    if "neighbour_count" in f and liquid.any():
        values["neighbours_mean"] = float(f["neighbour_count"][liquid].mean())
        values["neighbours_max"] = int(f["neighbour_count"].max())
    if "offenders" in f:
        values["guard_pairs"] = int(f["offenders"][liquid].sum())
    if start["solids"]:
        values["melted_fraction"] = 1.0 - values["solid_particles"] / start["solids"]
    if "heat_capacity" in wide:
        values.update(_thermal(wide, mobile, _melting_points(state, phase, f["material"])[mobile]))
    if do.need.boiling:
        values.update(boiling_ledger.series(do, start))
        if do.need.solids:  # melt may be lighter than the ambient liquid
            values["mass_created"] = values["mass"] + values["boiled_mass"] - start["mass"]
        else:
            values["mass_created"] = do.settings.particle_mass / 4 * values["quarters_missing"]
        values["mass_deleted"] = 0.0  # inactive slots were bubbles or vapour
        values["lost_particles"] = outside(x, do.params["domain"])
    for name, counted in _COUNTED.items():
        if any(getattr(do.need, need) for need in counted):
            values[name] = getattr(do.clock, name)
    return values


#: Running sums of the clock (a checkpoint keeps them), and what a scene needs one of to have them.
_COUNTED = {
    "energy_in": ("heaters", "ambient", "thermostats"),
    "melted": ("melting",),
    "frozen": ("freezing",),
}


_WANTED = (
    "phase material position velocity mass volume density density_ratio constraint neighbour_count offenders "
    "temperature heat_capacity heat_capacity_molten latent_point latent_capacity latent_energy"
).split()


def _carried_by_apic(state):
    """Mass and momentum of APIC particles, which have them (nodes only borrow them)."""
    m, v, there = state.read("apic_mass").astype(float), state.read("apic_velocity").astype(float), state.read("apic_phase") != INACTIVE
    momentum = (m * v)[:, there].sum(axis=1)
    found = {"mass": float(m[there].sum()), "mass_deleted": float(m[~there].sum())}
    return found | {f"momentum_{axis}": float(p) for axis, p in zip("xyz", momentum)}


def outside(position, domain):
    """Return the number of particles (3, n) outside of the box of a `melt.params.Domain`."""
    lower = np.array([domain.lower_x, domain.lower_y, domain.lower_z], dtype=np.float64)[:, None]
    upper = np.array([domain.upper_x, domain.upper_y, domain.upper_z], dtype=np.float64)[:, None]
    return int(((position < lower) | (position > upper)).any(axis=0).sum())


def coincident(position, counted, active):
    """Return how many ``counted`` particles are exactly where another active one is."""
    bits = (position + 0.0).view(np.uint64)  # 0.0 turns -0 into 0
    odd = np.array([[0x9E3779B97F4A7C15], [0xC2B2AE3D27D4EB4F], [0x165667B19E3779F9]], dtype=np.uint64)
    hashed = np.bitwise_xor.reduce(bits * odd, axis=0)
    there = np.flatnonzero(active)
    rank = there[np.argsort(hashed[there], kind="stable")]
    same = hashed[rank[1:]] == hashed[rank[:-1]]
    # equal places have equal hashes; the few candidates are compared in full
    some = np.union1d(rank[1:][same], rank[:-1][same])
    if not some.size:
        return 0
    _, place, count = np.unique(position[:, some], axis=1, return_inverse=True, return_counts=True)
    return int((counted[some] & (count[place.ravel()] > 1)).sum())


def measure_of(fields):
    """Return the name of the field that says how dense the liquid of a run is; None for one without (floods, still scenes)."""
    return next((name for name in ("constraint", "density_ratio", "density") if name in fields), None)


def compression(fields, liquid):
    """Return rho/rho_0 - 1 of the ``liquid`` particles, 0 where they are less dense.

    ``fields``: name -> array, with that of `measure_of`: the constraint before the last correction, the density ratio at
    the start of the last sub-step, or the density with mass and volume.
    """
    measure = measure_of(fields)
    error = fields[measure][liquid].astype(np.float64)
    if measure == "density":
        mass, volume = (fields[name][liquid].astype(np.float64) for name in ("mass", "volume"))
        error = error / (mass / np.maximum(volume, 1e-300))
    return np.maximum(error if measure == "constraint" else error - 1.0, 0.0)


def _melting_points(state, phase, material):
    """Return T_m (n,) [degC] from which the heat of a particle is counted: one for a solid and what it melts to."""
    if "material_melting_point" not in state:
        return np.zeros(phase.size)
    point = state.read("material_melting_point").astype(np.float64)
    point = np.where(np.isfinite(point), point, 0.0)
    of_melt = np.zeros(point.size)
    if "material_melts_to" in state:
        for k in np.flatnonzero(np.isfinite(state.read("material_melting_point")))[::-1]:
            of_melt[state.read("material_melts_to")[k]] = point[k]
    if "material_freezes_to" in state:
        to = state.read("material_freezes_to")
        of_melt = np.where(to >= 0, point[to], of_melt)
    return np.where(phase == SOLID, point[material], of_melt[material])


def _thermal(wide, mobile, reference):
    """Temperatures and energies of liquids and solids (a C of inf, which no step leaves, would not count)."""
    T, C = wide["temperature"][mobile], wide["heat_capacity"][mobile]
    if not T.size:
        return {}
    values = {"temperature_min": float(T.min()), "temperature_max": float(T.max())}
    free = np.isfinite(C)
    T, C, reference = T[free], C[free], reference[free]
    if C.any():
        sensible = C * (T - reference)
        if "latent_point" in wide:  # C below the melting point, C_molten above it
            point, molten, room = (
                wide[n][mobile][free] for n in ("latent_point", "heat_capacity_molten", "latent_capacity")
            )
            above = (room > 0) & (T > point)
            sensible = np.where(above, molten * (T - reference), sensible)  # the point is the reference
            C = np.where(above, molten, C)
        values["thermal_energy"] = float(sensible.sum())
        values["temperature_mean"] = float((C * T).sum() / C.sum())
    if "latent_energy" in wide:
        values["latent_energy"] = float(wide["latent_energy"][mobile].sum())
    return values
