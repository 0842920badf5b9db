"""CPU twin of `melt.reference.components`."""

import numpy as np

from melt._compile import cpu_helper, cpu_serial, cpu_stage, prange

PIECES = 64


@cpu_helper
def _root(label, s):
    while label[s] != s:
        label[s] = label[label[s]]
        s = label[s]
    return s


@cpu_serial
def components(site_links, site_link_count, site_component):
    """See `melt.reference.components.components`: union-find, the smaller root wins."""
    count = site_link_count.shape[0]
    for s in range(count):
        site_component[s] = s if site_link_count[s] > 0 else -1
    for s in range(count):
        if site_link_count[s] == 0:
            continue
        a = _root(site_component, s)
        for k in range(13):  # the other 13 offsets are the same links from the other side
            j = site_links[s, k]
            if j >= 0:
                b = _root(site_component, j)
                site_component[max(a, b)] = min(a, b)
                a = min(a, b)
    for s in range(count):
        if site_link_count[s] > 0:
            site_component[s] = site_component[site_component[s]]


@cpu_stage
def crumble(site_component, smallest, site_melting, melted, component_size):
    """See `melt.reference.components.crumble`."""
    count = site_component.shape[0]
    component_size[:] = 0
    for s in range(count):
        if site_component[s] >= 0:
            component_size[site_component[s]] += 1
    for piece in prange(PIECES):
        total = 0
        for s in range(count * piece // PIECES, count * (piece + 1) // PIECES):
            c = site_component[s]
            small = c >= 0 and component_size[np.uint64(max(c, 0))] < smallest
            site_melting[s] = 1 if small else 0
            total += 1 if small else 0
        melted[piece] = total
