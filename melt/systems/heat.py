"""The heat step: properties, sources, one of six solvers, ambient air. Melting line 13, spec 2.5, 3.5.

``do.settings``: ``heat_solver`` (see `SOLVERS`, or ``auto``), ``heat_substeps`` (a number, or
``auto``: as many as bring the Fourier number to 0.5), ``fourier_number`` of a step of ``dt`` (both of
the scene, see `fourier_number`), and of cg ``heat_tolerance``, ``heat_iterations``.
``do.need``: ``latent``, ``heaters``, ``ambient``, ``thermostats`` (walls or heaters of fixed temperature).
``do.clock.energy_in``: heat brought by heaters, ambient air and what has a fixed temperature [J].
"""

import contextlib
import math

import numpy as np

from melt.errors import MeltError
from melt.scene.model import SUBSTEPS_LIMIT

#: Above this Fourier number coloured pairs lose to backward Euler (spec 2.5, measured).
PAIRS_UP_TO = 0.5
OUTER_LIMIT = 8  # renewals of the states below, on and above the plateau
HALVINGS = 4


def fourier_number(law, dt, spacing, conductivity, density=1.0, specific_heat=1.0):
    """Return Fo = alpha dt / dx^2 of a material: alpha = 2 K (paper) or k / (rho c)."""
    alpha = 2 * conductivity if law == 0 else conductivity / (density * specific_heat)
    return alpha * dt / spacing**2


def start_heat(do):
    """Derive thermal properties, and the latent energy of the initial state."""
    do.thermal_properties()
    if do.need.latent:
        do.latent_start()
        do.latent_properties()


def heat(do, dt):
    """Advance temperature (and latent energy) by dt [s], t^n to t^(n+1)."""
    properties(do)
    # where temperatures are held, what flows from there is only seen in what the others gain
    with source(do, do.need.thermostats):
        with source(do, do.need.heaters and not do.need.thermostats):
            if do.need.heaters:
                do.heat_source(dt=dt)
        substeps = thermal_substeps(do.settings, dt)
        solver = chosen_solver(do.settings, dt)
        if solver != "pairs_coloured":  # that one walks cells, not lists
            do.heat_conductance()
        noted = [SOLVERS[solver](do, dt / substeps) or {} for _ in range(substeps)]
        for name, total in {"heat_iterations": sum, "heat_residual": np.max, "heat_fallback": max}.items():
            if found := [notes[name] for notes in noted if name in notes]:
                do.note(name, total(found))
        if do.need.ambient:
            do.surface()
            with source(do, not do.need.thermostats):
                do.ambient_cooling(dt=dt)
        if do.need.thermostats:
            properties(do)  # heaters fix a temperature by C = inf: the ledger needs the real one


def properties(do):
    """Conductivities, heat capacities and enthalpy curves of what is there."""
    do.thermal_properties()
    if do.need.latent:
        do.latent_properties()


@contextlib.contextmanager
def source(do, counts):
    """Add what the stages inside bring to ``clock.energy_in``, if it ``counts``. Reads back twice then."""
    before = content(do) if counts else 0.0
    yield
    if counts:
        do.clock.energy_in += content(do) - before


def content(do):
    """Return the heat content of liquids and solids [J], to the last digits: its changes are small."""
    do.heat_content()
    pieces = np.asarray(do.read("heat_content"), dtype=np.float64).ravel()
    return math.fsum(pieces) if np.isfinite(pieces).all() else math.nan


def _fourier(settings, dt):
    """Return the Fourier number of a step of ``dt`` (None: the scene's)."""
    return settings.fourier_number * (1.0 if dt is None else dt / settings.dt)


def _planned_pairs(settings):
    """Return whether ``auto`` takes pairs at the scene's dt: then a run has no fields of cg."""
    given = settings.heat_substeps
    return settings.heat_solver == "auto" and (given == "auto" or settings.fourier_number / given <= PAIRS_UP_TO)


def thermal_substeps(settings, dt=None):
    """Return the number of thermal sub-steps of a step of ``dt`` (None: the scene's).

    More than a given number where ``auto`` took pairs for the scene's dt and this one is too long for them.
    """
    given = 1 if settings.heat_substeps == "auto" else settings.heat_substeps
    if settings.heat_substeps != "auto" and not _planned_pairs(settings):
        return given
    number = _fourier(settings, dt)
    if number > SUBSTEPS_LIMIT * PAIRS_UP_TO:
        raise MeltError(
            f"heat.substeps = 'auto': a Fourier number of {number:.3g} asks for more "
            f"than {SUBSTEPS_LIMIT} sub-steps: lower time.dt or the conductivity, or set "
            "heat.substeps = 1 (cg is stable)"
        )
    return max(given, math.ceil(number / PAIRS_UP_TO))


def chosen_solver(settings, dt=None):
    """Return the solver that ``settings`` names or, for ``auto``, the one that a step of ``dt`` asks for."""
    if settings.heat_solver != "auto":
        return settings.heat_solver
    return "pairs_coloured" if _fourier(settings, dt) / thermal_substeps(settings, dt) <= PAIRS_UP_TO else "cg"


def pairs_seq(do, dt):
    """Every pair alone, forward and in reverse, in lexicographic order (serial)."""
    do.heat_pairs_seq(dt=dt)


def pairs_coloured(do, dt):
    """Every pair alone, forward and in reverse, in the order of 18 colours of cells."""
    do.heat_pairs_coloured(dt=dt)


def onesided(do, dt):
    """Each particle updates itself from frozen neighbours, in both orders (not conserving)."""
    sweep = dt if do.params["heat"].full_sweep else dt / 2
    for reverse in (0.0, 1.0):
        do.heat_onesided(dt=sweep, reverse=reverse)
        do.swap("temperature", "temperature_next")


def dt_limit(do):
    """Return the largest dt [s] at which forward Euler keeps the maximum principle."""
    do.heat_rate()
    rate = float(np.max(do.read("heat_rate")))
    return 1 / rate if rate > 0 else math.inf


def explicit(do, dt):
    """Forward Euler in as many sub-steps as the maximum principle needs."""
    limit = dt_limit(do)
    if dt > SUBSTEPS_LIMIT * limit:
        raise MeltError(
            f"heat.solver = 'explicit': it is stable for steps of {limit:.3g} s, more than {SUBSTEPS_LIMIT} "
            f"of them in dt = {dt:.3g} s: lower time.dt or the conductivity, or set heat.solver to 'auto'"
        )
    substeps = max(1, math.ceil(dt / limit))
    for _ in range(substeps):
        do.heat_explicit(dt=dt / substeps)
        do.swap("temperature", "temperature_next")
    return {"heat_iterations": substeps}


def cg(do, dt):
    """Backward Euler of all pairs, in halved steps where it does not converge, in the end by pairs."""
    iterations, error, left, notes = 0, 0.0, dt, {}
    for halving in range(HALVINGS + 1):
        part = left / 2**halving
        for _ in range(2**halving):
            used, error, converged = backward_euler(do, part)
            iterations += used
            if not converged:
                break
            left -= part
        if converged:
            break
    else:
        do.heat_pairs_seq(dt=left)  # bounded and conserving whatever the step and the conductivities
        notes["heat_fallback"] = 1
    return {**notes, "heat_iterations": iterations, "heat_residual": error}


def backward_euler(do, dt):
    """Try one implicit step; return (iterations, imbalance over the range of T, converged)."""
    rtol, limit = do.settings.heat_tolerance, do.settings.heat_iterations
    iterations, start, converged = 0, 0.0, False
    do.cg_guess()  # T' = T^n, no flux
    for _ in range(OUTER_LIMIT if do.need.latent else 1):
        do.cg_state()
        do.cg_start(dt=dt)
        start = max(start, float(do.read("cg_sums")[0].sum()))  # r.z of the first guess
        for k in range(limit):
            if k % 4 == 0 and not float(do.read("cg_sums")[0].sum()) > rtol**2 * start:
                break
            do.cg_apply(dt=dt)
            do.cg_step()
            do.cg_turn()
            iterations += 1
        do.heat_balance(dt=dt)
        imbalance, lowest, highest = do.read("heat_error")
        error, extent = float(imbalance.max()), float(highest.max() - lowest.min())
        # the flux form rounds differences of T that dt G / C multiplies
        hottest = float(max(abs(highest.max()), abs(lowest.min())))
        rounding = 1000 * float(np.finfo(imbalance.dtype).eps) * hottest
        converged = error <= 100 * rtol * extent + rounding
        if converged or not math.isfinite(error):
            break
    if not converged:
        do.cg_guess()  # no flux: the step is not taken
    do.heat_finish()  # T^(n+1) in flux form
    return iterations, error / extent if extent > 0 else error, converged


SOLVERS = {
    "pairs_seq": pairs_seq,
    "pairs_coloured": pairs_coloured,
    "onesided": onesided,
    "explicit": explicit,
    "cg": cg,
}
