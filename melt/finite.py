"""Values that are not finite: refused at the start, found and named during a run. Melting spec 6."""

import math

import numpy as np

from melt.errors import InputError, Unstable
from melt.fields import CARRIED, FIELDS
from melt.fields_slime import APIC_CARRIED
from melt.physics.phases import INACTIVE, LIQUID, SOLID
from melt.stages import STAGES
from melt.state import REAL
from melt.watch.alarms import particle, remedy, when

#: Outer steps between looks at the fields where that needs a read-back from a device (else every step).
CHECK_EVERY = 16
_MAY_BE_INFINITE = {"material_melting_point"}


def check_initial(initial, precision):
    """Refuse initial arrays that hold NaN, infinity, or more than the precision can hold.

    Raises:
        InputError: names the field, the first index and the value.
    """
    largest = float(np.finfo(REAL[precision]).max)
    for name, values in initial.arrays.items():
        values = np.asarray(values)
        if values.dtype.kind != "f":
            continue
        limit = math.inf if name in _MAY_BE_INFINITE else math.sqrt(largest / 3) if name == "velocity" else largest  # of its square
        bad = ~(np.abs(values) <= limit)  # a NaN fails the comparison
        if bad.any():
            index = np.unravel_index(int(np.argmax(bad)), bad.shape)
            where = ", ".join(map(str, index))
            most = f" of at most {limit:.3g} in {precision} precision" if np.isfinite(values[index]) else ""
            raise InputError(
                f"initial state: {name}[{where}] = {values[index]:g} {FIELDS[name].unit}{_more(bad)}: "
                f"it must be a finite number{most}"
            )
    mobile = np.isin(initial["phase"], (LIQUID, SOLID))
    for name in ("mass", "rest_volume"):
        bad = mobile & (initial[name] <= 0)
        if bad.any():
            i = int(np.argmax(bad))
            raise InputError(
                f"initial state: {name}[{i}] = {initial[name][i]:g} {FIELDS[name].unit}: "
                "liquid and solid particles need more than 0"
            )


def _more(bad):
    others = int(bad.sum()) - 1
    return f" (and {others} more)" if others else ""


def check_number(name, value, above=None, at_least=None):
    """Return a number given by the user, or raise `InputError` if it is not finite or out of range."""
    value = float(value)
    low = above is not None and value <= above or at_least is not None and value < at_least
    if low or not math.isfinite(value):
        allowed = f" greater than {above:g}" if above is not None else f" of at least {at_least:g}"
        raise InputError(f"{name} = {value:g} is not allowed: it must be a finite number{allowed}")
    return value


def check_state(sim):
    """Raise `Unstable` if a particle of the run holds a value that is not finite.

    Looks at the fields that particles carry from step to step; all others derive from them.
    """
    active = active_of(sim.state)
    for name in (*CARRIED, *APIC_CARRIED):
        if name in sim.state and FIELDS[name].kind != "int":
            if bad_values(name, sim.state.read(name), active).any():
                raise not_finite(sim)


def bad_values(name, values, active):
    """Return where an array of field ``name`` holds what is neither finite nor means something.

    ``active``: of `active_of`.
    """
    bad = ~np.isfinite(values) & (name not in _INFINITE_ALLOWED)
    for axis, extent in enumerate(FIELDS[name].shape):
        if extent in active:
            bad &= active[extent].reshape([-1 if k == axis else 1 for k in range(bad.ndim)])
    return bad


def active_of(state):
    """Return {extent: which of its particles are there}."""
    return {of: state.read(phase) != INACTIVE for of, phase in PHASE.items() if phase in state}


def not_finite(sim):
    """Return the `Unstable` that names a field that is not finite, and where.

    Within the step that is blamed it spreads to neighbours and to other fields: of those, the field that the fewest
    particles have bad is named (the first in stage order), and one of these particles.
    """
    state, clock = sim.state, sim.do.clock
    active = active_of(state)
    found = []
    names = [name for stage in sim.prepared.stages for name in STAGES[stage].writes]
    for name in dict.fromkeys([*APIC_CARRIED, *names, *CARRIED]):  # nodes have what they have from APIC particles
        field = FIELDS.get(name)
        if name not in state or field.kind == "int" or field.shape[-1] not in active:
            continue
        bad = bad_values(name, state.read(name), active)
        bad = bad.any(axis=tuple(range(bad.ndim - 1)))
        if bad.any():
            found.append((int(bad.sum()), name, bad))
    if found:
        _, name, bad = min(found, key=lambda f: f[0])
        i, of = int(np.argmax(bad)), "apic_" if FIELDS[name].shape[-1] == "apic" else ""
        name = name.removesuffix("_kept")  # of the start of a sub-step
        stages = " or ".join(s for s in sim.prepared.stages if name in STAGES[s].writes) or "none: it was so from outside"
        what = f"field {name} (stage {stages}) is not finite at {particle(sim, i, of)}{_more(bad)}"
        return Unstable(f"{when(clock)}: {what}.", remedy=remedy(sim))
    speed = np.where(active["particle"], np.linalg.norm(state.read("velocity").astype(np.float64), axis=0), -1.0)
    i = int(np.argmax(speed))
    return Unstable(
        f"{when(clock)}: the square of field velocity or of force/mass (stage motion_bounds) is not finite.",
        f"Fastest is particle {int(state.read('id')[i])} with {speed[i]:.3g} m/s.",
        remedy=remedy(sim),
    )


#: Extents of what is looked at, and the field that says which of them are there.
PHASE = {"particle": "phase", "apic": "apic_phase"}
#: Fields in which infinity means something (see `melt.fields`).
_INFINITE_ALLOWED = {
    "latent_point",
    "heat_capacity",
    "heat_capacity_molten",
    "heat_linear",
    "cg_diagonal",
    "heat_error",  # extremes of a share of the particles that has none with a heat capacity
}
