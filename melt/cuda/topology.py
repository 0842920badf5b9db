"""CUDA twin of `melt.reference.topology`."""

from melt._compile import cuda, cuda_kernel
from melt.params import REFILL_ALL, REFILL_CHANGED


@cuda_kernel
def _clear(flag):
    s = cuda.grid(1)
    if s < flag.shape[0]:
        flag[s] = 0


@cuda_kernel
def _mark_bodies(site_body, site_melting, body_changed):
    s = cuda.grid(1)
    if s < site_body.shape[0] and site_melting[s]:
        cuda.atomic.max(body_changed, site_body[s], 1)


@cuda_kernel
def _mark_refill(site_body, site_melting, site_region, site_region_count, lattice, body_changed, site_dirty):
    s = cuda.grid(1)
    if s >= site_body.shape[0]:
        return
    refill = 0
    if lattice.refill == REFILL_ALL:
        refill = 3
    elif lattice.refill == REFILL_CHANGED:
        refill = body_changed[site_body[s]] if site_body[s] >= 0 else 0
    elif site_region_count[s] > 0:
        for k in range(site_region.shape[1]):
            j = site_region[s, k]
            if j >= 0:
                refill |= site_melting[j]
    site_dirty[s] = refill


@cuda_kernel
def _mark_renew(site_region, site_region_count, site_dirty):
    # own bit 2 beside the others' bit 1: a word is written by its owner only
    s = cuda.grid(1)
    if s >= site_region_count.shape[0]:
        return
    renew = site_dirty[s] & 1
    if site_region_count[s] > 0:
        for k in range(site_region.shape[1]):
            j = site_region[s, k]
            if j >= 0:
                renew |= site_dirty[j] & 1
    site_dirty[s] |= 2 * renew


def mark_dirty(site_body, site_melting, site_region, site_region_count, lattice, site_dirty, body_changed):
    """See `melt.reference.topology.mark_dirty`."""
    sites = site_body.shape[0]
    _clear.launch(sites, body_changed)
    if lattice.refill == REFILL_CHANGED:
        _mark_bodies.launch(sites, site_body, site_melting, body_changed)
    _mark_refill.launch(
        sites, site_body, site_melting, site_region, site_region_count, lattice, body_changed, site_dirty
    )
    _mark_renew.launch(sites, site_region, site_region_count, site_dirty)


@cuda_kernel
def _unlink(site_melting, site_links, site_link_count):
    s = cuda.grid(1)
    if s >= site_melting.shape[0]:
        return
    total = 0
    for k in range(27):
        j = site_links[s, k]
        if j >= 0:
            if site_melting[s] or site_melting[j]:
                site_links[s, k] = -1
            else:
                total += 1
    site_link_count[s] = total


def unlink(site_melting, site_links, site_link_count):
    """See `melt.reference.topology.unlink`."""
    _unlink.launch(site_melting.shape[0], site_melting, site_links, site_link_count)


@cuda_kernel
def _fill_regions(site_links, site_link_count, site_dirty, lattice, site_region, site_region_count):
    """Fill one region per thread; entry = site + (hops) * sites until the last loop.

    The hop label rides on the entry, so that a pass expands what the pass before has written
    and no queue is needed.
    """
    s = cuda.grid(1)
    sites = site_links.shape[0]
    if s >= sites or not site_dirty[s] & 1:
        return
    slots = site_region.shape[1]
    w = lattice.width
    side = 2 * w + 1
    for k in range(slots):
        site_region[s, k] = -1
    if site_link_count[s] == 0:
        site_region_count[s] = 0
        return
    site_region[s, slots // 2] = s
    for hop in range(w):
        for at in range(slots):
            entry = site_region[s, at]
            if entry < hop * sites or entry >= (hop + 1) * sites:
                continue
            i = entry - hop * sites
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
                    site_region[s, slot] = j + (hop + 1) * sites
    found = 0
    for k in range(slots):
        if site_region[s, k] >= 0:
            site_region[s, k] %= sites
            found += 1
    site_region_count[s] = found


def fill_regions(site_links, site_link_count, site_dirty, lattice, site_region, site_region_count):
    """See `melt.reference.topology.fill_regions`."""
    _fill_regions.launch(
        site_links.shape[0], site_links, site_link_count, site_dirty, lattice, site_region, site_region_count
    )
