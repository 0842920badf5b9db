"""CPU twin of `melt.reference.topology`."""

import numpy as np

from melt._compile import cpu_stage, prange
from melt.params import REFILL_ALL, REFILL_CHANGED

CHUNKS = 64


@cpu_stage
def mark_dirty(site_body, site_melting, site_region, site_region_count, lattice, site_dirty, body_changed):
    """See `melt.reference.topology.mark_dirty`."""
    count = site_body.shape[0]
    slots = np.uint64(site_region.shape[1])
    body_changed[:] = 0
    if lattice.refill == REFILL_CHANGED:
        for s in range(count):
            if site_melting[s]:
                body_changed[site_body[s]] = 1
    for s in prange(count):
        refill = 0
        if lattice.refill == REFILL_ALL:
            refill = 1
        elif lattice.refill == REFILL_CHANGED:
            refill = body_changed[site_body[s]] if site_body[s] >= 0 else 0
        elif site_region_count[s] > 0:
            for k in range(slots):
                j = site_region[s, k]
                refill |= site_melting[np.uint64(j if j >= 0 else s)]
        site_dirty[s] = refill
    # own bit 2 beside the others' bit 1: a word is written by its owner only
    for s in prange(count):
        renew = site_dirty[s] & 1
        if site_region_count[s] > 0:
            for k in range(slots):
                j = site_region[s, k]
                renew |= site_dirty[np.uint64(j if j >= 0 else s)] & 1
        site_dirty[s] |= 2 * renew | (2 if lattice.refill == REFILL_ALL else 0)


@cpu_stage
def unlink(site_melting, site_links, site_link_count):
    """See `melt.reference.topology.unlink`."""
    for s in prange(site_melting.shape[0]):
        total = 0
        for k in range(np.uint64(27)):
            j = site_links[s, k]
            if j >= 0:
                if site_melting[s] or site_melting[np.uint64(j)]:
                    site_links[s, k] = -1
                else:
                    total += 1
        site_link_count[s] = total


@cpu_stage
def fill_regions(site_links, site_link_count, site_dirty, lattice, site_region, site_region_count):
    """See `melt.reference.topology.fill_regions`; the queue of a pass stands behind the last one's."""
    count = site_links.shape[0]
    w = np.int64(lattice.width)
    side = 2 * w + 1
    slots = site_region.shape[1]
    for chunk in prange(CHUNKS):
        queue = np.empty(slots, np.int64)
        for s in range(count * chunk // CHUNKS, count * (chunk + 1) // CHUNKS):
            if not site_dirty[s] & 1:
                continue
            for k in range(np.uint64(slots)):
                site_region[s, k] = -1
            found = 0
            if site_link_count[s] > 0:
                queue[0] = slots // 2
                site_region[s, slots // 2] = s
                found = 1
            start, end = 0, found
            for _ in range(w):
                # entries of this pass wait for the next one, or the region would leak round notches
                for f in range(start, end):
                    at = queue[f]
                    i = site_region[s, at]
                    x, y, z = at % side, at // side % side, at // (side * side)
                    for k in range(27):
                        j = site_links[i, k]
                        if j < 0:
                            continue
                        a, b, c = x + k % 3 - 1, y + k // 3 % 3 - 1, z + k // 9 - 1
                        if a < 0 or b < 0 or c < 0 or a >= side or b >= side or c >= side:
                            continue
                        slot = (c * side + b) * side + a
                        if site_region[s, slot] < 0:
                            site_region[s, slot] = j
                            queue[found] = slot
                            found += 1
                start, end = end, found
            site_region_count[s] = found
