"""Ledgers of a liquid that boils: bubbles, mass in quarters of a particle, heat. Host side. Boiling spec 3."""

import math

import numpy as np

from melt.physics.phases import BUBBLE, LIQUID, SOLID, VAPOUR

#: Name -> (unit, meaning) of every value that `series` returns, beside temperatures.
SERIES = {
    "bubbles": ("1", "bubbles there are"),
    "bubble_radius_mean": ("m", ""),
    "bubble_radius_max": ("m", ""),
    "bubble_volume": ("m^3", "of all bubbles, by their radii"),
    "vapour_particles": ("1", ""),
    "boiled": ("1", "liquid particles that became bubbles (or sent them out) since the start"),
    "merged": ("1", "bubbles that others took up since the start"),
    "vanished": ("1", "bubbles that left through the surface without a burst since the start"),
    "burst": ("1", "bubbles that burst at the surface since the start"),
    "deferred": ("1", "particles that wait for free slots in this step"),
    "vapour_dropped": ("1", "vapour particles that found no slot since the start"),
    "condensed": ("1", "particles that returned as condensate since the start (mass_model = recycle)"),
    "condensed_heat": ("J", "that vapour gave off to the air to become this condensate since the start"),
    "released_mass": ("kg", "liquid that left with bubbles since the start, less what returned (each particle as that of the start)"),
    "boiled_mass": ("kg", "of the particles that became bubbles since the start (with solids: their melt may be lighter)"),
    "boiled_heat": ("J", "that these took along, above liquid at 0 degC, with the heat that had melted them"),
    "steam_mass": ("kg", "what the bubbles that there are would hold as real gas: far less than the liquid they stand for"),
    "quarters_missing": (
        "1", "4 liquid particles + cargo + released quarters that did not return, less those of the start and of what melted: 0"
    ),
    "heat_in": ("J", "brought by the heater since the start"),
    "heat_lost": ("J", "lost at the surface since the start"),
    "heat_missing": (
        "J",
        "m (c_p T + latent store) of the liquid, what bubbles took with them and condensed_heat, less the start and what the heater "
        "brought: the rounding of temperatures (heat_model = particle10 does not conserve, grid has no such balance). With [heat], "
        "of all of the tank: ice and what it took up to melt, too",
    ),
    "surface_height": ("m", "above the floor: 95th percentile of the liquid"),
    "push_x": ("kg m/s", "momentum that bursts gave to the liquid since the start"),
    "push_y": ("kg m/s", ""),
    "push_z": ("kg m/s", ""),
    "merge_x": ("kg m/s", "momentum taken out of merging bubbles since the start (merge_velocity = up)"),
    "merge_y": ("kg m/s", ""),
    "merge_z": ("kg m/s", ""),
}

TAKEN = ("boiled_mass", "boiled_heat")  # booked where particles differ in what they take along


def series(do, start):
    """Return the values of `SERIES`; ``start`` holds ``liquids`` (number at the start)."""
    state, ledger, b = do.state, do.clock.ledger, do.params["boiling"]
    get = {n: state.read(n) for n in ("phase", "temperature", "latent_store", "mass", "cargo", "bubble_radius", "position")}
    phase = get["phase"]
    liquid, bubble = phase == LIQUID, phase == BUBBLE
    radius = get["bubble_radius"][bubble].astype(np.float64)
    volume = float((4 / 3 * np.pi * radius**3).sum())
    T, m = get["temperature"][liquid].astype(np.float64), get["mass"][liquid].astype(np.float64)
    settings = do.settings
    particle = settings.particle_mass
    cargo = int(get["cargo"][bubble].sum())
    kept = settings.boiling.mass_model == "nucleate"
    values = {name: ledger[name] for name in SERIES if name in ledger and (do.need.heat or name not in TAKEN)}
    height = get["position"][2, liquid].astype(np.float64) - float(do.params["bubbles"].floor)
    values |= {
        "bubbles": int(bubble.sum()),
        "bubble_radius_mean": float(radius.mean()) if radius.size else 0.0,
        "bubble_radius_max": float(radius.max(initial=0.0)),
        "bubble_volume": volume,
        "vapour_particles": int((phase == VAPOUR).sum()),
        "released_mass": particle / 4 * ledger["released_quarters"],
        "steam_mass": settings.boiling.bubbles.gas_density * volume,
        "quarters_missing": 4 * int(liquid.sum()) + cargo + ledger["released_quarters"] - 4 * (start["liquids"] + do.clock.melted),
        "surface_height": float(np.quantile(height, 0.95)) if height.size else 0.0,
    }
    if do.need.heat:
        taken = ledger["boiled_heat"] - ledger["heat_in"] + ledger["heat_lost"] - do.clock.energy_in
        values["heat_missing"] = tank_heat(do) + taken - ledger["start_heat"]
    elif settings.boiling.heat_model != "grid":  # there a particle only samples the grid, and what boils takes nothing from it
        values["heat_missing"] = _heat(do, m, T, get["latent_store"][liquid], cargo, kept, particle, b)
    if T.size and not do.need.heat:
        values |= {
            "temperature_min": float(T.min()),
            "temperature_max": float(T.max()),
            "temperature_mean": float((m * T).sum() / m.sum()),
        }
    return values


def _heat(do, m, T, store, cargo, kept, particle, b):
    """Return the heat that the ledger misses [J]."""
    ledger, c_p = do.clock.ledger, float(b.specific_heat)
    brought = ledger["heat_in"] - ledger["heat_lost"]
    held = math.fsum(m * (c_p * T + store.astype(np.float64)))
    gone = 0.0 if kept else particle / 4 * (cargo + ledger["released_quarters"])
    left = gone * (c_p * float(b.boiling_point) + float(b.latent_heat)) + ledger["excess_heat"] + ledger["condensed_heat"]
    return held + left - ledger["start_heat"] - brought


def tank_heat(do):
    """Return the heat of liquid and solids above liquid at 0 degC [J], from temperatures and materials alone.

    Liquid: m (c T + latent store) and the heat that melted it. Solid: m (c_s (T - T_m) + c T_m) below its melting point T_m,
    m c T above it (without latent heat: c_s stays), and the heat of melting that it has taken up. c is the liquids'. One that
    never melts: m c_s T.
    """
    phase, material = do.read("phase"), do.read("material")
    mass, T, store = (do.read(n).astype(np.float64) for n in ("mass", "temperature", "latent_store"))
    c = float(do.params["boiling"].specific_heat)
    point = do.read("material_melting_point").astype(np.float64)[material]
    latent = np.isfinite(point) & (do.read("material_latent_heat")[material] > 0 if do.need.latent else False)
    point = np.where(np.isfinite(point), point, 0.0)
    own = do.read("material_specific_heat").astype(np.float64)[material]
    above = np.where(latent, c, own) * np.maximum(T - point, 0.0)
    solid = own * np.minimum(T - point, 0.0) + above + c * point
    liquid, frozen = phase == LIQUID, phase == SOLID
    parts = [(mass * (c * T + store))[liquid], (mass * solid)[frozen]]
    if do.need.latent:
        parts.append(do.read("latent_energy").astype(np.float64)[liquid | frozen])
    return math.fsum(np.concatenate(parts))
