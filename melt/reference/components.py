"""Connected components of the lattice. Melting spec 3.3."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


def components(site_links, site_link_count, site_component):
    """Write for every live site the smallest live site connected to it, -1 for others.

    Reads: site_links (s, 27), site_link_count (s,). Writes: site_component (s,).
    """
    count = len(site_link_count)
    site_component[:] = -1
    if count == 0:
        return
    i, k = np.nonzero(site_links >= 0)
    graph = coo_array((np.ones(len(i)), (i, site_links[i, k])), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    live = np.flatnonzero(site_link_count > 0)
    smallest = np.full(count, count)
    np.minimum.at(smallest, label[live], live)
    site_component[live] = smallest[label[live]]


def crumble(site_component, smallest, site_melting, melted, component_size):
    """Let components of less than ``smallest`` sites melt at once.

    Reads: site_component (s,). Writes: site_melting (s,), melted (64,), component_size (s,).
    """
    count = len(site_component)
    live = site_component >= 0
    component_size[:] = np.bincount(site_component[live], minlength=count)[:count]
    site_melting[:] = 0
    site_melting[live] = component_size[site_component[live]] < smallest
    pieces = np.arange(65) * count // 64
    melted[:] = [site_melting[a:b].sum() for a, b in zip(pieces[:-1], pieces[1:])]
