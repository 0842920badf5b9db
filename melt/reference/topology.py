"""Links and regions of the lattice. Melting spec 3.1 rules 4 and 5, 3.2."""

from collections import deque

import numpy as np

from melt.reference._lattice import offsets


def mark_dirty(site_body, site_melting, site_region, site_region_count, lattice, site_dirty, body_changed):
    """Write which regions must be refilled (bit 1) and which sums renewed (bit 2).

    Run before `unlink` and `fill_regions`, on the regions as they are. Refilled is every region
    that contains a melting site (``refill`` 2), every region of a body that has one (1), or every
    region (0). A sum is renewed if its region is refilled or contains a site whose region is,
    because the number of regions that share that site changed (a reach of 2w).

    Reads: site_body, site_melting (s,), site_region (s, (2w+1)^3), site_region_count (s,).
    Writes: site_dirty (s,).
    """
    count = len(site_melting)
    members = [m[m >= 0] if n > 0 else m[:0] for m, n in zip(site_region, site_region_count)]
    if lattice.refill == 0:
        site_dirty[:] = 3
        return
    if lattice.refill == 1:
        refill = np.isin(site_body, site_body[site_melting > 0]) & (site_body >= 0)
    else:
        refill = np.array([site_melting[members[s]].any() for s in range(count)], dtype=bool)
    renew = np.array([refill[s] or refill[members[s]].any() for s in range(count)], dtype=bool)
    site_dirty[:] = refill + 2 * renew


def unlink(site_melting, site_links, site_link_count):
    """Clear the links of melting sites and all links to them. Rule 4.

    Writes: site_links (s, 27), site_link_count (s,).
    """
    melting = np.flatnonzero(site_melting)
    site_links[melting] = -1
    site_links[np.isin(site_links, melting)] = -1
    site_link_count[:] = (site_links >= 0).sum(axis=1)


def fill_regions(site_links, site_link_count, site_dirty, lattice, site_region, site_region_count):
    """Fill the regions whose ``site_dirty`` has bit 1: sites within w hops, by breadth-first search.

    The box of (2w+1)^3 offsets never cuts a path of w hops. Empty for a site without links.

    Reads: site_links (s, 27), site_link_count, site_dirty (s,).
    Writes: site_region (s, (2w+1)^3), site_region_count (s,).
    """
    w = int(lattice.width)
    side = 2 * w + 1
    step = offsets(27)
    for s in np.flatnonzero(site_dirty & 1):
        site_region[s] = -1
        found = {}
        if site_link_count[s] > 0:
            found[int(s)] = (0, (0, 0, 0))
        front = deque(found)
        while front:
            i = front.popleft()
            hops, at = found[i]
            if hops == w:
                continue
            for j, o in zip(site_links[i], step):
                if j >= 0 and int(j) not in found:
                    found[int(j)] = (hops + 1, tuple(np.add(at, o)))
                    front.append(int(j))
        for i, (_, (x, y, z)) in found.items():
            site_region[s, ((z + w) * side + y + w) * side + x + w] = i
        site_region_count[s] = len(found)
