"""Lattice sites and regions of the check inputs, by adjacency matrices (specs of melting 2.7, 3.2)."""

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from melt.check._cloud import SOLID, SPACING, body_cells

SPARE = 6  # sites kept for freezing


def adjacency(cell, body, live, connect):
    """Return the (sites, sites) matrix of bonds, itself included: same body, voxel neighbours."""
    d = np.abs(cell[:, :, None] - cell[:, None, :])
    reach = {6: 1, 18: 2, 26: 3}[int(connect)]
    touch = (d.max(axis=0) <= 1) & (d.sum(axis=0) <= reach)
    both = live[:, None] & live[None, :]
    return touch & both & (body[:, None] == body[None, :])


def by_offset(member, cell, width):
    """Spread a membership matrix over the (2w+1)^3 voxel offsets; -1 for none."""
    side = 2 * width + 1
    table = np.full((len(member), side**3), -1)
    i, j = np.nonzero(member)
    d = cell[:, j] - cell[:, i] + width
    table[i, (d[2] * side + d[1]) * side + d[0]] = j
    return table


def within(bonds, hops):
    """Return which sites are at most ``hops`` bonds apart."""
    reach = np.diag(np.diag(bonds))
    for _ in range(hops):
        reach = (reach.astype(np.int64) @ bonds) > 0
    return reach


def components(bonds):
    """Return the smallest live site of each site's connected component, -1 if not live."""
    live = np.diag(bonds)
    if len(bonds) == 0:
        return np.zeros(0, int)
    _, label = connected_components(csr_matrix(bonds), directed=False)
    first = np.full(label.max() + 1, len(bonds))
    np.minimum.at(first, label, np.arange(len(bonds)))
    return np.where(live, first[label], -1)


def quaternion(R):
    """Return (w, x, y, z) of a rotation matrix with w >= 0."""
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(R).as_quat()
    q = np.array([w, x, y, z])
    return q if w >= 0 else -q


def _best_rotation(A):
    U, _, Vt = np.linalg.svd(A)
    return U @ np.diag([1, 1, np.sign(np.linalg.det(U @ Vt)) or 1]) @ Vt


def _regions(a, arrays, rng):
    """Add region sums, centres, rotations and motions that fit the positions, relative to the own site."""
    count = len(a["site_body"])
    live, particle = a["site_region_count"] > 0, a["site_particle"]
    a["site_position"], a["site_velocity"] = np.zeros((3, count)), np.zeros((3, count))
    for name in ("position", "velocity"):
        a[f"site_{name}"][:, live] = arrays[name][:, particle[live]]
    share = np.zeros(count)
    share[live] = arrays["mass"][particle[live]] / a["site_region_count"][live]
    mass, rest, centre, mean, shift = np.zeros(count), *(np.zeros((3, count)) for _ in range(4))
    rotation = np.zeros((4, count))
    rotation[0] = 1
    for r in np.flatnonzero(live):
        member = a["site_region"][r][a["site_region"][r] >= 0]
        m = share[member]
        x = a["site_position"][:, member] - a["site_position"][:, [r]]
        X0 = a["site_rest"][:, member] - a["site_rest"][:, [r]]
        mass[r], rest[:, r], centre[:, r], mean[:, r] = (
            m.sum(),
            X0 @ m / m.sum(),
            x @ m / m.sum(),
            x.mean(axis=1),
        )
        R = _best_rotation((m * (x - centre[:, [r]])) @ (X0 - rest[:, [r]]).T)
        rotation[:, r], shift[:, r] = quaternion(R), centre[:, r] - R @ rest[:, r]
    a.update(
        region_share=share,
        region_mass=mass,
        region_rest=rest,
        region_centre=centre,
        region_mean=mean,
        region_shift=shift,
        region_rotation=rotation,
    )
    a["region_velocity"] = rng.normal(size=(3, count)) * live
    a["region_spin"] = rng.normal(size=(3, count)) * 3 * live
    a["goal"] = rng.normal(size=(3, count)) * 0.05 * SPACING * live


def _components(a, rng):
    """Add the pose and motion of rigid components, random, at every site."""
    shape = (3, len(a["site_body"]))
    for name in ("component_centre", "component_rest"):
        a[name] = rng.normal(size=shape) * SPACING
    q = rng.normal(size=(4, shape[1])) + np.array([[3.0], [0], [0], [0]])
    a["component_rotation"] = q * np.sign(q[:1]) / np.linalg.norm(q, axis=0)
    a["component_push"], a["component_twist"] = rng.normal(size=shape) * 10, rng.normal(size=shape) * 50


def _layout(n, arrays, rng):
    """Place the sites: those of the bodies, some melted, some vacant, and spare ones at the end."""
    bodies = body_cells(n)
    spare = SPARE if bodies else 0
    cells = np.concatenate([*bodies, np.zeros((spare, 3), int)]) if bodies else np.zeros((0, 3), int)
    body = np.concatenate([np.full(len(c), b) for b, c in enumerate(bodies)] + [np.full(spare, -1)])
    rest = np.zeros((3, len(cells)))
    for b, own in enumerate(bodies):
        rest[:, body == b] = ((own - own.min(axis=0)) * SPACING).T
    a = {"site_cell": np.ascontiguousarray(cells.T), "site_body": body.astype(int), "site_rest": rest}
    particle = np.full(len(cells), -1)
    # a melted particle remembers its site but is not on it any more
    has = np.flatnonzero((arrays["site"] >= 0) & (arrays["phase"] == SOLID))
    particle[arrays["site"][has]] = has
    live = particle >= 0
    a["site_particle"] = particle
    return a, live


def sites(n, arrays, rng, width=2, connect=26):
    """Add all site and region fields to ``arrays`` (which must hold position, phase, site, mass)."""
    a, live = _layout(n, arrays, rng)
    cell, body = a["site_cell"], a["site_body"]
    bonds = adjacency(cell, body, live, connect)
    reach = within(bonds, width)
    a["site_links"], a["site_link_count"] = by_offset(bonds, cell, 1), bonds.sum(axis=1)
    a["site_region"], a["site_region_count"] = by_offset(reach, cell, width), reach.sum(axis=1)
    a["site_component"] = components(bonds)
    a["site_adjacent"] = by_offset(adjacency(cell, body, body >= 0, connect), cell, 1)
    surface = live & (a["site_link_count"] <= connect)
    melting = surface & (rng.random(len(body)) < 0.15)
    a["site_melting"] = melting.astype(int)

    after = adjacency(cell, body, live & ~melting, connect)
    reach_after = within(after, width)
    refill = (reach & melting[None, :]).any(axis=1)
    changed = reach_after.sum(axis=1) != reach.sum(axis=1)
    renew = (reach & changed[None, :]).any(axis=1)
    a["site_dirty"] = refill.astype(int) + 2 * renew
    a["links_after"], a["link_count_after"] = by_offset(after, cell, 1), after.sum(axis=1)
    _regions(a, arrays, rng)
    _components(a, rng)
    arrays.update(a)


def after_melting(arrays):
    """Return the arrays as they are between the stages ``unlink`` and ``fill_regions``."""
    return {**arrays, "site_links": arrays["links_after"], "site_link_count": arrays["link_count_after"]}


def after_freezing(arrays, connect):
    """Return the arrays as the stage ``freeze_sites`` leaves them: claimed sites are linked."""
    cell, body = arrays["site_cell"], arrays["site_body"]
    live = (arrays["site_link_count"] > 0) | (arrays["claim"] >= 0)
    bonds = adjacency(cell, body, live, connect)
    return {**arrays, "site_links": by_offset(bonds, cell, 1), "site_link_count": bonds.sum(axis=1)}


def warm_start(arrays):
    """Return the arrays with region rotations as a previous step left them: near, not equal."""
    rng = np.random.default_rng(5)
    q = arrays["region_rotation"] + 0.02 * rng.normal(size=arrays["region_rotation"].shape)
    q = q / np.linalg.norm(q, axis=0) if q.size else q
    return {**arrays, "region_rotation": np.where(q[:1] < 0, -q, q)}
