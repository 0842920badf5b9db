"""Set-up of lattice sites on the host: integer cells and bodies -> links, dirty flags, rotations."""

import numpy as np


def bonding(connect):
    """Return for each of the 27 voxel offsets (x fastest) whether voxels at it bond.

    Raises:
        ValueError: ``connect`` is not 6, 18 or 26.
    """
    if int(connect) not in (6, 18, 26):
        raise ValueError(f"connect = {connect}: a voxel bonds with 6, 18 or 26 others")
    k = np.arange(27)
    steps = np.abs(k % 3 - 1) + np.abs(k // 3 % 3 - 1) + np.abs(k // 9 - 1)
    return steps <= {6: 1, 18: 2, 26: 3}[int(connect)]


def links(cell, body, taken, connect=26):
    """Return the sites of the same body at the 27 voxel offsets, (s, 27), -1 for none.

    ``cell``: (3, s) integer voxels, ``body``: (s,), ``taken``: (s,) sites that count (the others
    have no links and are nobody's). Bodies in adjacent voxels never bond.

    Raises:
        ValueError: two sites of one body share a voxel.
    """
    cell, body = np.asarray(cell, np.int64).reshape(3, -1), np.asarray(body, np.int64)
    table = np.full((body.size, 27), -1, np.int32)
    used = np.flatnonzero(np.asarray(taken, bool))
    if used.size == 0:
        return table
    low = cell[:, used].min(axis=1) - 1
    size = cell[:, used].max(axis=1) + 2 - low

    def key(c, b):
        return ((b * size[2] + c[2] - low[2]) * size[1] + c[1] - low[1]) * size[0] + c[0] - low[0]

    own = key(cell[:, used], body[used])
    order = np.argsort(own, kind="stable")
    keys = own[order]
    same = np.flatnonzero(keys[1:] == keys[:-1])
    if same.size:
        a, b = used[order[same[0]]], used[order[same[0] + 1]]
        raise ValueError(f"sites {a} and {b} of body {body[a]} share the voxel {tuple(cell[:, a].tolist())}")
    for k in np.flatnonzero(bonding(connect)):
        offset = np.array([[k % 3 - 1], [k // 3 % 3 - 1], [k // 9 - 1]])
        wanted = key(cell[:, used] + offset, body[used])
        at = np.minimum(np.searchsorted(keys, wanted), keys.size - 1)
        table[used, k] = np.where(keys[at] == wanted, used[order[at]], -1)
    return table


def lattice_fields(site_cell, site_body, site_particle, connect=26):
    """Return the start values of the site fields that the stages need, by field name.

    Every site is marked dirty; `melt.systems.topology.build_lattice` then fills regions and sums.

    Args:
        site_cell: (3, s) integer voxel of each site, vacant ones included.
        site_body: (s,) body of each site.
        site_particle: (s,) particle at the site, -1 where it is vacant.
        connect: 6, 18 or 26 voxel neighbours bond.

    Raises:
        ValueError: a ``connect`` that is not allowed, a doubly filled voxel.
    """
    count = len(site_body)
    table = links(site_cell, site_body, np.asarray(site_particle) >= 0, connect)
    rotation = np.zeros((4, count))
    rotation[0] = 1
    return {
        "site_links": table,
        "site_link_count": (table >= 0).sum(axis=1).astype(np.int32),
        "site_adjacent": links(site_cell, site_body, np.ones(count, bool), connect),
        "site_dirty": np.full(count, 3, np.int32),
        "region_rotation": rotation,
        "component_rotation": rotation.copy(),
    }
