"""Heat of a liquid that boils or melts what is in it, and the velocity boost by warmth. Boiling spec 2.3, 2.4 (S9, S10)."""

import math

import numpy as np

from melt.errors import MeltError
from melt.scene.model import SUBSTEPS_LIMIT
from melt.systems import heat as heat_equation
from melt.systems.reads import finite, largest, total

SAFE = 0.8  # of the explicit step limit: a maximum principle holds up to 1


def warm(do, dt):
    """Heater, conduction, loss at the surface; then what is above the boiling point goes into the latent store.

    A heater that holds its temperature (dirichlet) does so after conduction too: else what it touches would
    always be a little colder than T_h. With [heat] one equation serves liquid and solids: that of melting.
    """
    grid = do.need.boiling and do.settings.boiling.heat_model == "grid"
    if do.need.heater:
        heat(do, dt)
    if do.need.heat:
        heat_equation.heat(do, dt)
    elif grid:
        conduct_grid(do, dt)
    else:
        conduct(do, dt)
    if do.need.surface_loss:
        cool(do, dt)
    if do.need.heater and do.settings.boiling.heater.mode == "dirichlet":
        heat(do, dt)
    if grid:
        do.voxel_sample()
    if do.need.boiling:
        do.boil_store()


def heat(do, dt):
    """Let the heater warm what touches it."""
    heater = do.settings.boiling.heater
    stage = do.voxel_heater if do.settings.boiling.heat_model == "grid" else do.boil_heater
    stage(target=heater_temperature(do), share=_share(heater, dt))
    do.clock.ledger["heat_in"] += total(do, "heater_heat")


def conduct(do, dt):
    """Exchange heat between particles, in as many steps as the maximum principle asks for. Eqs (10), (11)."""
    if do.settings.boiling.heat_model == "particle":
        do.boil_sums()
    do.boil_rate()
    number = dt * largest(do, "heat_rate")
    n = _steps(number / SAFE)
    for _ in range(n):
        do.boil_exchange(dt=dt / n)
        do.swap("temperature", "temperature_next")
    do.note("conduction_steps", n)


def conduct_grid(do, dt):
    """Conduct on the grid, which does not flow. Eq (9)."""
    number = dt * float(do.params["tank"].number)
    n = _steps(number * 6 / SAFE)
    for _ in range(n):
        do.voxel_heat(dt=dt / n)
        do.swap("voxel_temperature", "voxel_temperature_next")
    do.note("conduction_steps", n)


def cool(do, dt):
    """Let the surface lose heat to the air."""
    from melt.systems.boiling import surface

    b = do.settings.boiling
    do.boil_cooling(target=b.air_temperature, share=-math.expm1(-b.surface_transfer * dt), height=surface(do))
    do.clock.ledger["heat_lost"] += total(do, "lost_heat")


def heater_temperature(do):
    """Return T_h(t) [degC]."""
    heater, s = do.settings.boiling.heater, do.settings
    if heater.rate is None:
        return heater.temperature
    return min(heater.temperature, s.start_temperature + heater.rate * do.clock.time)


def _share(heater, dt):
    return 1.0 if heater.mode == "dirichlet" else -math.expm1(-heater.transfer * dt)


def _steps(number):
    if not number <= SUBSTEPS_LIMIT:
        raise MeltError(
            f"boiling: conduction asks for {number:.3g} steps in a sub-step, more than {SUBSTEPS_LIMIT}: "
            "lower boiling.diffusivity or time.dt"
        )
    return max(1, math.ceil(number * (1 - 1e-9)))


def boost(do, dt):
    """Warm liquid moves faster, eq (12); the default form leaves the momentum of the liquid as it is."""
    mean = means(do)
    do.boost(**mean, dt=dt)
    if do.settings.boiling.boost == "rate":
        after = means(do)
        do.shift_velocity(**{k: after[k] - mean[k] for k in ("mean_u", "mean_v", "mean_w")})


def means(do):
    """Return mean velocity and temperature of the liquid, weighted with mass."""
    do.liquid_sums()
    m, *sums = np.asarray(do.read("liquid_sums"), dtype=np.float64).sum(axis=1)
    return dict(zip(("mean_u", "mean_v", "mean_w", "mean_temperature"), (finite(s / m) if m > 0 else 0.0 for s in sums)))
