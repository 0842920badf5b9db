"""Ledgers of a flood at one output step: volume, energy, what the water does. Host side, float64."""

import math

import numpy as np

from melt.physics.phases import AIRBORNE, LIQUID

#: Name -> (unit, meaning) of every value that `series` returns.
SERIES = {
    "volume": ("m^3", "water on the terrain and in the air"),
    "entered_volume": ("m^3", "that inflows, edges and rain brought since the start"),
    "left_edge": ("m^3", "that left over open edges"),
    "left_blocked": ("m^3", "that was taken out of places where no water may be"),
    "infiltrated": ("m^3", "that seeped away"),
    "dried": ("m^3", "in columns that became too thin and were taken out"),
    "volume_error": ("1", "(volume + left - entered - volume at the start) / (volume at the start + entered)"),
    "kinetic_energy": ("J", "of the horizontal motion, with v^(n-1/2)"),
    "potential_energy": ("J", "rho g V (b + d/2), above the lowest node of the terrain"),
    "momentum_x": ("kg m/s", ""),
    "momentum_y": ("kg m/s", ""),
    "largest_speed": ("m/s", ""),
    "largest_depth": ("m", "of a column"),
    "mean_depth": ("m", "of columns, weighted with volume"),
    "wet_area": ("m^2", "sum of V/d"),
    "liquid_particles": ("1", "columns"),
    "airborne_particles": ("1", "columns that fall"),
    "isolated_columns": ("1", "with fewer than 3 neighbours"),
    "clamped_columns": ("1", "whose support is at one of its limits"),
    "unsolved_columns": ("1", "whose depth was not solved to the tolerance"),
    "neighbours_mean": ("1", "in the lists, which reach a growth further than the support"),
    "neighbours_max": ("1", ""),
    "crowded_columns": ("1", "with more than twice the neighbours of even water (pile-up)"),
    "lost_particles": ("1", "columns taken out where no water may be"),
}
EVEN = 22  # neighbours within the support of evenly spaced columns: pi 2.66^2


def series(do, start):
    """Return the values of `SERIES`, as {name: float}."""
    state, ledger = do.state, do.clock.ledger
    order = np.argsort(state.read("id"), kind="stable")
    phase = state.read("phase")[order]
    here = (phase == LIQUID) | (phase == AIRBORNE)
    wide = {
        name: state.read(name)[..., order][..., here].astype(np.float64)
        for name in ("position", "velocity", "rest_volume", "depth", "bed", "mass")
    }
    V, d, v, m = wide["rest_volume"], wide["depth"], wide["velocity"], wide["mass"]
    water = phase[here] == LIQUID
    g = float(do.params["flood"].gravity)
    volume = math.fsum(V)
    values = {
        "volume": volume,
        "kinetic_energy": float(0.5 * (m * (v[:2] ** 2).sum(axis=0)).sum()),
        "potential_energy": float(g * (m * np.where(water, wide["bed"] + 0.5 * d, wide["position"][2])).sum()),
        "momentum_x": float((m * v[0]).sum()),
        "momentum_y": float((m * v[1]).sum()),
        "largest_speed": float(np.sqrt((v[:2] ** 2).sum(axis=0).max(initial=0.0))),
        "largest_depth": float(d[water].max(initial=0.0)),
        "mean_depth": float((V * d)[water].sum() / max(V[water].sum(), 1e-300)),
        "wet_area": float((V / np.maximum(d, 1e-12))[water].sum()),
        "liquid_particles": int(water.sum()),
        "airborne_particles": int((~water).sum()),
    }
    left = 0.0
    for name in ("left_edge", "left_blocked", "infiltrated", "dried"):
        values[name] = ledger.get(name, 0.0)
        left += values[name]
    values["entered_volume"] = ledger.get("entered", 0.0)
    brought = ledger["volume_start"] + values["entered_volume"]
    values["volume_error"] = (volume + left - brought) / max(brought, 1e-300)
    values["lost_particles"] = round(values["left_blocked"] / do.settings.column_volume)
    values.update(_lists(do, state))
    return values


def _lists(do, state):
    """Counts from the neighbour lists of the columns."""
    water = state.read("phase") == LIQUID
    if not water.any():
        return {}
    count, flags = state.read("neighbour_count"), state.read("depth_state")
    return {
        "neighbours_mean": float(count[water].mean()),
        "neighbours_max": int(count[water].max()),
        "isolated_columns": int((flags[water] & 8 > 0).sum()),
        "unsolved_columns": int((flags[water] & 4 > 0).sum()),
        "clamped_columns": int((flags[water] & 3 > 0).sum()),
        "crowded_columns": int((count[water] > 2 * EVEN * float(do.params["flood"].growth) ** 2).sum()),
    }
