"""Bubbles and vapour: birth, rise, growth, merging, bursting. Boiling spec 2.5, 2.6, 3 (S1, S7, S8, S11).

Bubbles are slots of the particle arrays, listed by ascending id at every sort. Counts that decide what runs
are read back: nothing is launched for bubbles while there are none.
"""

import math

import numpy as np

from melt.boiling import threshold_of
from melt.boiling_ledger import tank_heat
from melt.errors import MeltError
from melt.physics.phases import BUBBLE, INACTIVE, VAPOUR
from melt.systems.reads import finite, largest, total

#: Counters since the start, kept by checkpoints: particles boiled, bubbles gone, quarters of liquid let go, heat [J].
LEDGER = {
    "boiled": 0, "merged": 0, "vanished": 0, "burst": 0, "released_quarters": 0, "deferred": 0, "vapour": 0,
    "vapour_dropped": 0, "condensed": 0, "condensed_heat": 0.0, "heat_in": 0.0, "heat_lost": 0.0,
    "boiled_mass": 0.0, "boiled_heat": 0.0, "excess_heat": 0.0, "start_heat": 0.0,
    "push_x": 0.0, "push_y": 0.0, "push_z": 0.0, "merge_x": 0.0, "merge_y": 0.0, "merge_z": 0.0,
}
BURST = 2  # of bubble_fate
LAST_ID = 2**31 - 1


def start(do):
    """Begin the ledger, and count bubbles that a scene starts with."""
    clock = do.clock
    listed(do)
    clock.ledger = dict(LEDGER)
    clock.next_id = do.size("particle")
    if clock.bubbles:
        do.largest_bubble()
        clock.largest_bubble = max(clock.largest_bubble, largest(do, "largest_bubble"))
    clock.ledger["start_heat"] = start_heat(do)


def start_heat(do):
    """Return the heat of the liquid at the start [J]; with [heat] that of solids, too."""
    if do.need.heat:
        return 0.0 if do.recording else tank_heat(do)
    do.boil_content()
    return total(do, "boil_content")


def present(do):
    """Return whether there are bubbles."""
    return do.need.boiling and do.clock.bubbles > 0


def births(do, dt):
    """Turn liquid particles that have taken up their latent heat into four bubbles each (S1).

    Candidates are served by ascending id as long as there are slots; the others wait as liquid. The list of bubbles is
    made first: a run that goes on from a checkpoint has none.
    """
    if present(do):
        listed(do)
    clock, ledger = do.clock, do.clock.ledger
    threshold = np.int32(threshold_of(dt, do.settings.boiling.nucleation_time))
    if do.params["boiling"].threshold != threshold:  # the sub-step changed
        do.params["boiling"] = do.params["boiling"]._replace(threshold=threshold)
        do.forget()
    do.boil_candidates(**_moment(do))
    wanted = _list(do, "candidate", 1, "birth", ordered=True)
    ledger["deferred"] = 0
    if not wanted:
        return
    free = _list(do, "phase", INACTIVE, "free")
    served = min(wanted, free // 4, (do.settings.bubble_slots - clock.bubbles) // 4)
    ledger["deferred"] = wanted - served
    if served < wanted:
        do.warning = (
            f"slots for {do.settings.bubble_slots} bubbles are taken: {wanted - served} particles at the boiling point wait. "
            "Fix: raise boiling.bubbles.capacity"
        )
    if served > 0:
        if do.need.heat:
            _take(do, served)
        do.spawn_bubbles(**_moment(do), first_id=_ids(clock, 4 * served), served=served)
        ledger["excess_heat"] += total(do, "birth_excess")
        ledger["boiled"] += served
        clock.largest_bubble = max(clock.largest_bubble, float(do.params["bubbles"].birth_radius))
        listed(do)


def _take(do, served):
    """Book what the particles that boil take along: melt may be lighter than the rest, and has its heat of fusion."""
    do.boiled_sums(served=served)
    mass, heat, fusion = np.asarray(do.read("boiled_sums")).sum(axis=1)
    do.clock.ledger["boiled_mass"] += finite(float(mass))
    do.clock.ledger["boiled_heat"] += finite(float(heat + fusion))


def listed(do):
    """List the bubbles by ascending id."""
    do.clock.bubbles = _list(do, "phase", BUBBLE, "bubble", ordered=True)


def rise(do, dt):
    """Drag with its reaction on the liquid, motion, drift towards other bubbles (S6, S7)."""
    if not present(do):
        return
    do.bubble_drag(dt=dt)
    do.bubble_reaction()
    do.bubble_move(dt=dt)
    do.bubble_drift(dt=dt)  # eq (13)
    do.bubble_shift()
    if do.need.solids:
        do.bubble_avoid()


def change(do, dt):
    """Grow, merge, leave through the surface (S8)."""
    if not present(do):
        return
    do.bubble_growth(dt=dt)
    do.largest_bubble()
    do.clock.largest_bubble = largest(do, "largest_bubble")
    if do.clock.bubbles > 1:
        merge(do)
    leave(do)


def merge(do):
    """Make one bubble of each connected group of overlapping ones."""
    clock = do.clock
    edge = 1.0 / float(do.params["grid"].inverse_cell)
    coarse = max(1, math.ceil(2.001 * clock.largest_bubble / edge))
    do.bubble_cell(coarse=coarse)
    do.cell_sort(cell="bubble_cell", order="bubble_order", cell_start="bubble_start")
    do.merge_label(coarse=coarse)
    do.merge_bubbles()
    before = clock.bubbles
    listed(do)
    if clock.bubbles < before:
        clock.ledger["merged"] += before - clock.bubbles
        do.largest_bubble()
        clock.largest_bubble = largest(do, "largest_bubble")
        _book(do, "merge", np.asarray(do.read("merge_removed")).sum(axis=1))


def leave(do):
    """Let bubbles at the surface vanish or burst; a burst pushes the liquid around, eq (14)."""
    from melt.systems.boiling import surface
    from melt.systems.liquid_heat import means

    ledger = do.clock.ledger
    do.surface_column()
    do.burst_test(height=surface(do) + float(do.params["pbf"].support))
    if _list(do, "bubble_fate", BURST, "burst", ordered=True):
        before = means(do)
        do.burst_push()
        after, mass = means(do), float(np.asarray(do.read("liquid_sums"))[0].sum())
        _book(do, "push", [mass * (after[k] - before[k]) for k in ("mean_u", "mean_v", "mean_w")])
        if do.need.vapour:
            steam(do)
    do.remove_bubbles()
    vanished, burst, quarters = (int(n) for n in np.asarray(do.read("released"), dtype=np.int64).sum(axis=1))
    if vanished + burst:
        for name, value in (("vanished", vanished), ("burst", burst), ("released_quarters", quarters)):
            ledger[name] += value
        listed(do)


def condense(do):
    """Let released liquid return to the surface in whole particles, at the temperature of the air.

    At the end of a sub-step: nothing reads the neighbours of the new particles before they are listed. What the
    vapour gave off to become that cold is booked: it leaves to the air.
    """
    clock, ledger, b = do.clock, do.clock.ledger, do.params["boiling"]
    due = ledger["released_quarters"] // 4
    if not due:
        return
    served = min(due, _list(do, "phase", INACTIVE, "free"))
    if served:
        do.surface_column()
        do.condense(**_moment(do), first_id=_ids(clock, served), served=served)
        ledger["condensed"] += served
        ledger["released_quarters"] -= 4 * served
        cooled = float(b.specific_heat) * (float(b.boiling_point) - do.settings.boiling.air_temperature) + float(b.latent_heat)
        ledger["condensed_heat"] += served * do.settings.particle_mass * cooled


def dry(do):
    """Return whether all of the liquid has boiled away: none is left, none is to come."""
    if not do.settings.liquid.particles or do.need.condensate or do.settings.boiling.mass_model == "nucleate":
        return False
    return do.clock.ledger["boiled"] >= do.settings.liquid.particles and not present(do)


def steam(do):
    """Set vapour free where bubbles burst; what finds no slot is dropped."""
    clock, ledger = do.clock, do.clock.ledger
    wanted = int(do.read("burst_count")[0]) * int(do.params["vapour"].per_burst)
    free = _list(do, "phase", INACTIVE, "free")
    served = max(0, min(wanted, free, do.settings.vapour_slots - ledger["vapour"]))
    ledger["vapour_dropped"] += wanted - served
    if served:
        do.vapour_source(**_moment(do), first_id=_ids(clock, served), served=served)
        ledger["vapour"] += served


def vapour(do, dt):
    """Move the vapour above the surface, and choose its support for the next step, eq (16)."""
    if not do.clock.ledger["vapour"]:
        return
    do.vapour_density()
    do.vapour_force(dt=dt)
    do.vapour_precision()
    do.vapour_move(dt=dt)
    do.clock.ledger["vapour"] = _list(do, "phase", VAPOUR, "birth")  # a list that is free by now


def _list(do, flag, key, name, ordered=False):
    """List the slots with flag == key as ``name``_index, by id if ``ordered``; return their number."""
    do.list_slots(flag=flag, key=key, index=f"{name}_index", count=f"{name}_count")
    number = int(do.read(f"{name}_count")[0])
    if ordered and number:
        do.order_by_id(index=f"{name}_index", count=f"{name}_count")
    return number


def _ids(clock, number):
    """Return the first of so many ids that nothing had before."""
    first = clock.next_id
    if first + number > LAST_ID:
        raise MeltError(f"boiling: {first:,} particles, bubbles and vapour so far: no new id is below 2^31; start a new run")
    clock.next_id += number
    return first


def _moment(do):
    """Return the number of the sub-step as two words, int32 bit patterns."""
    k = do.clock.sub_step
    return {name: int(np.uint32(word & 0xFFFFFFFF).astype(np.int32)) for name, word in (("step_low", k), ("step_high", k >> 32))}


def _book(do, what, vector):
    for axis, value in zip("xyz", vector):
        do.clock.ledger[f"{what}_{axis}"] += finite(float(value))
