"""Nodes that come and go where APIC particles carry the mass: none for what has none near, not two in one place. Slime spec 2.6.

Host side: it happens seldom, and nothing is lost by it, as nodes own neither mass nor momentum.
"""

import numpy as np
from scipy.spatial import cKDTree

from melt.params_slime import MASSLESS, ORPHAN
from melt.physics.phases import INACTIVE, LIQUID

EVERY = 10  # outer steps between two looks
APART, CLOSE = 0.7, 0.3  # spacings: a new node keeps this distance; of two closer ones the one with the higher id goes


def tend(do):
    """Delete nodes without mass and the second of two in one place; give orphans a node; return whether one did.

    Every `EVERY` outer steps.
    """
    if do.recording:
        for name in ("apic_id", "apic_state", "node_state"):
            do.read(name)
    if do.clock.step % EVERY or do.recording:
        return False
    orphans = np.asarray(do.read("apic_state")) == ORPHAN
    gone = _superfluous(do)
    if gone.size:
        phase, mass = do.read("phase"), do.read("mass")
        phase[gone], mass[gone] = INACTIVE, 0
        do.give("phase", phase)
        do.give("mass", mass)
        do.note("nodes_deleted", gone.size)
    added = _add(do, np.flatnonzero(orphans)) if orphans.any() else 0
    if added:
        do.note("nodes_added", added)
    return added > 0


def _superfluous(do):
    """Return the slots of nodes to delete."""
    phase, ids = np.asarray(do.read("phase")), np.asarray(do.read("id"))
    held = np.asarray(do.read("held")) if do.need.nozzles else np.zeros(phase.size, int)
    nodes = np.flatnonzero((phase == LIQUID) & (held == 0))
    massless = nodes[np.asarray(do.read("node_state"))[nodes] == MASSLESS]
    pairs = cKDTree(np.asarray(do.read("position")).T[nodes]).query_pairs(CLOSE * do.settings.spacing, output_type="ndarray")
    i, j = nodes[pairs[:, 0]], nodes[pairs[:, 1]]
    return np.union1d(massless, np.where(ids[i] > ids[j], i, j)).astype(np.int64)


def _add(do, orphans):
    """Put nodes at orphans that are far enough from all nodes and from each other, by ascending id; return how many."""
    d = do.settings.spacing
    phase, position = do.read("phase"), do.read("position")
    velocity, mass, rest = do.read("velocity"), do.read("mass"), do.read("rest_volume")
    x, v = np.asarray(do.read("apic_position")), np.asarray(do.read("apic_velocity"))
    nodes = np.flatnonzero(phase == LIQUID)
    far = np.ones(orphans.size, bool)
    if nodes.size:
        far = cKDTree(position.T[nodes]).query(x.T[orphans])[0] > APART * d
    chosen = []
    for p in orphans[far][np.argsort(np.asarray(do.read("apic_id"))[orphans[far]], kind="stable")]:
        if all(np.linalg.norm(x[:, p] - x[:, q]) > APART * d for q in chosen):
            chosen.append(p)
    awaited = sum((nozzle.layers - do.clock.layers[nozzle.name]) * nozzle.count for nozzle in do.settings.nozzles)
    room = phase.size - do.clock.active - awaited
    chosen = np.array(chosen[: max(room, 0)], np.int64)
    slots = np.flatnonzero(phase == INACTIVE)[-chosen.size :] if chosen.size else chosen
    if not slots.size:
        return 0
    phase[slots], position[:, slots], velocity[:, slots] = LIQUID, x[:, chosen], v[:, chosen]
    rest[slots] = do.settings.node_volume
    mass[slots] = 0  # until it gets its share
    for name, values in (("phase", phase), ("position", position), ("velocity", velocity), ("rest_volume", rest), ("mass", mass)):
        do.give(name, values)
    for name in ("poisson_pressure", "viscous_pressure", "density_impulse", "divergence_impulse"):
        if do.has(name):  # of whoever had the slot before
            values = do.read(name)
            values[slots] = 0
            do.give(name, values)
    do.clock.active += slots.size
    return int(slots.size)
