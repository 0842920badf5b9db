"""What can be known of a scene that boils before it runs, and where its model leaves nature. Boiling spec 2.3, 3, 6, 8."""

import math

import numpy as np

from melt.boiling import diffusivity_of, heater_box, slots_of
from melt.scene.presets import WATER_DIFFUSIVITY


def boiling_findings(scene, initial):
    """Return [(level, text, fix)] of a scene with [boiling] and its initial state."""
    return [*_heater(scene), *_contact(scene, initial), *_heat(scene), *_slots(scene, initial.counts["liquid"])]


def _contact(scene, initial):
    """Whether the heater touches liquid, and when the first bubble may come."""
    b, box, d = scene.boiling, heater_box(scene), scene.spacing
    if box is None:
        return []
    x = initial["position"][:, initial["phase"] == 0]
    over = ((x[:2] >= box[0][:, None]) & (x[:2] <= box[1][:, None])).all(axis=0)
    if x.size and not (over & (x[2] - scene.domain.lower[2] < d)).any():
        text = f"boiling.heater touches no liquid particle at the start: {_span(*box)}, spacing {d:g} m"
        return [("warning", text, "a larger boiling.heater.half_size")]
    rise, above = b.heater.temperature - scene.fluid.temperature, b.heater.temperature - b.boiling_point
    if b.heater.mode != "robin" or b.heater.rate is not None or b.heater.transfer == 0 or above <= 0 or rise <= 0:
        return []
    # of a particle that gives nothing to its neighbours
    warm = math.log(rise / above) / b.heater.transfer
    store = 0.0 if b.heat_model == "grid" else b.latent_scale * b.latent_heat / (b.specific_heat * b.heater.transfer * above)
    text = f"boiling: a particle at the heater boils after {warm + store:.2g} s at the earliest ({store:.2g} s of it for its latent heat)"
    if warm + store > scene.time.end:
        return [("warning", f"{text}; the run ends at {scene.time.end:g} s", "a later time.end, or a hotter boiling.heater.temperature")]
    return [("note", text, "")]


def _heater(scene):
    b, heater = scene.boiling, scene.boiling.heater
    if heater is None:
        return [("note", "boiling: there is no heater ([boiling.heater])", "")]
    low = np.array(scene.domain.lower[:2], float)
    floor = f"the floor, {_span(low, low + np.array(scene.domain.cells[:2]) * scene.spacing)}"
    box = heater_box(scene)
    if box is None:
        text = f"boiling.heater: no part of it is on {floor}: nothing is heated"
        return [("warning", text, "boiling.heater.centre within the floor")]
    found = []
    asked = None if heater.half_size is None else 4 * heater.half_size[0] * heater.half_size[1]
    if asked is not None and np.prod(box[1] - box[0]) < asked * (1 - 1e-9):
        found.append(("note", f"boiling.heater is cut to {floor}: it heats {_span(*box)}", ""))
    if heater.temperature <= b.boiling_point and scene.fluid.temperature < b.boiling_point:
        text = f"boiling.heater.temperature = {heater.temperature:g} degC is not above the boiling point of {b.boiling_point:g} degC"
        if heater.mode == "robin" or heater.temperature < b.boiling_point:
            found.append(("note", f"{text}: nothing boils", ""))
    return found


def _span(low, high):
    return f"x {low[0]:g} to {high[0]:g}, y {low[1]:g} to {high[1]:g} m"


def _heat(scene):
    b, d = scene.boiling, scene.spacing
    alpha = diffusivity_of(scene)
    times = f"{alpha / WATER_DIFFUSIVITY:,.3g} times as fast as in water"
    found = []
    if scene.heat is None:  # else [heat] says how it conducts
        found.append(("note", f"boiling: heat conducts with {alpha:.3g} m^2/s, {times} (boiling.diffusivity)", ""))
    if b.latent_scale == 0 or b.heat_model == "grid":
        why = "boiling.latent_scale = 0" if b.latent_scale == 0 else "boiling.heat_model = grid has no latent heat"
        found.append(("note", f"boiling is free of charge ({why}): liquid at the boiling point vaporises without any heat", ""))
    mass, steam = scene.fluid.density * d**3, b.bubbles.gas_density * d**3
    text = (
        f"boiling: a particle is {mass:.3g} kg of liquid, and its four bubbles would hold {steam:.3g} kg of steam, "
        f"1/{mass / steam:,.0f} of it: bubbles stand for the vapour, they do not contain it (boiling.mass_model = {b.mass_model})"
    )
    return [*found, ("note", text, "")]


def _slots(scene, particles):
    b = scene.boiling
    bubbles, vapour = slots_of(scene, particles)
    text = f"boiling: slots for {bubbles:,} bubbles, those of {bubbles // 4:,} of {particles:,} liquid particles at once"
    if b.vapour is not None:
        text += f", and for {vapour:,} vapour particles, those of {vapour // b.vapour.per_burst:,} bursts within {b.vapour.life:g} s"
    return [("note", text, "")]
