"""How an outer step is divided into sub-steps, and what is said when its bounds do not allow that."""

import math

from melt.errors import Unstable


def divide(do, dt, limits, speeds, remedy, stage):
    """Return (n_sub, dt / n_sub), the fewest sub-steps that all ``limits`` {bound: seconds} allow, and note why.

    ``speeds`` and ``remedy`` complete the message of a step that needs too many; ``stage`` measured the speeds.

    Raises:
        Unstable: the limits ask for more than ``n_sub_max`` sub-steps (never silently unstable).
    """
    s = do.settings
    governing = min(limits, key=limits.get)
    n_sub = s.n_sub or count(do, dt, limits[governing])
    if s.n_sub is None and n_sub > s.n_sub_max:
        raise Unstable(
            f"time step: at t = {do.clock.time:.4g} s the bound '{governing}' allows sub-steps of {limits[governing]:.3g} s, "
            f"{n_sub:.6g} of them in dt = {dt:g} s, but time.n_sub_max is {s.n_sub_max} ({speeds}): "
            f"lower time.dt, raise time.n_sub_max, or {remedy}.",
            stage=stage,
        )
    do.note("n_sub", n_sub)
    do.note("governing_bound", "given" if s.n_sub else governing)
    do.note("step_over_limit", dt / n_sub / limits[governing])  # above 1 a given n_sub is too small
    do.warning = ". Fix: ".join(filter(None, over_limit(s, dt, limits))) if s.n_sub else ""
    return n_sub, dt / n_sub


def fewest(dt, longest):
    """Return into how many sub-steps of at most ``longest`` a step is divided, infinity if no number is enough."""
    wanted = dt / longest if longest > 0 else math.inf
    return max(1, math.ceil(wanted * (1 - 1e-9))) if math.isfinite(wanted) else math.inf


def count(do, dt, longest):
    """Return the fewest parts of ``dt`` that are at most ``longest`` [s].

    Of a halved step as many as the whole one had, where ``n_sub_max`` allows that: else only the outer step were halved.
    """
    needed, whole = (fewest(span, longest) for span in (dt, dt * 2**do.clock.halvings))
    return max(needed, min(whole, do.settings.n_sub_max))


def over_limit(settings, dt, limits):
    """Return (what is wrong, remedy) of a given n_sub whose sub-steps exceed a bound; ("", "") if none does."""
    governing = min(limits, key=limits.get)
    n_sub, most = settings.n_sub, limits[governing]
    if dt / n_sub <= 1.0001 * most:
        return "", ""
    return (
        f"time.n_sub = {n_sub} makes sub-steps of {dt / n_sub:.3g} s, the bound '{governing}' allows {most:.3g} s: the run may burst",
        f"time.n_sub = {fewest(dt, most):.9g}, or 'auto'"
        + (f", or a fluid.sound_speed below {settings.sound_speed:.3g} m/s" if governing == "sound" else ""),
    )
