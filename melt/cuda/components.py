"""CUDA twin of `melt.reference.components`."""

from melt._compile import cuda, cuda_kernel, device_empty
from melt.cuda._count import count_pieces


@cuda_kernel
def _own_label(site_link_count, label):
    s = cuda.grid(1)
    if s < label.shape[0]:
        label[s] = s if site_link_count[s] > 0 else -1


@cuda_kernel
def _hook(site_links, site_link_count, label, changed):
    """Lower the label of the site's root to the smallest label next to the site.

    Labels only ever fall and stay within the component, so any interleaving ends at its smallest site.
    """
    s = cuda.grid(1)
    if s >= label.shape[0] or site_link_count[s] == 0:
        return
    own = label[s]
    least = own
    for k in range(27):
        j = site_links[s, k]
        if j >= 0:
            least = min(least, label[j])
    if least < own:
        cuda.atomic.min(label, own, least)
        cuda.atomic.min(label, s, least)
        cuda.atomic.max(changed, 0, 1)


@cuda_kernel
def _jump(label):
    s = cuda.grid(1)
    if s >= label.shape[0] or label[s] < 0:
        return
    root = label[s]
    while label[root] != root:
        root = label[root]
    label[s] = root


def components(site_links, site_link_count, site_component):
    """See `melt.reference.components.components`; reads one flag back per pass."""
    sites = site_link_count.shape[0]
    _own_label.launch(sites, site_link_count, site_component)
    changed = device_empty(1, site_component.dtype)
    more = sites > 0
    while more:
        changed[0] = 0
        _hook.launch(sites, site_links, site_link_count, site_component, changed)
        _jump.launch(sites, site_component)
        more = bool(changed[0])


@cuda_kernel
def _clear(size):
    s = cuda.grid(1)
    if s < size.shape[0]:
        size[s] = 0


@cuda_kernel
def _measure(site_component, size):
    s = cuda.grid(1)
    if s < size.shape[0] and site_component[s] >= 0:
        cuda.atomic.add(size, site_component[s], 1)


@cuda_kernel
def _mark_small(site_component, smallest, size, site_melting):
    s = cuda.grid(1)
    if s >= size.shape[0]:
        return
    c = site_component[s]
    site_melting[s] = 1 if c >= 0 and size[c] < smallest else 0


def crumble(site_component, smallest, site_melting, melted, component_size):
    """See `melt.reference.components.crumble`."""
    sites = site_component.shape[0]
    _clear.launch(sites, component_size)
    _measure.launch(sites, site_component, component_size)
    _mark_small.launch(sites, site_component, smallest, component_size, site_melting)
    count_pieces.launch(melted.shape[0], site_melting, melted)
