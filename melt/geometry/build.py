"""Initial state of a scene: arrays named as in `melt.fields`, float64 and int32."""

from dataclasses import dataclass, field

import numpy as np

from melt.boiling import slots_of
from melt.errors import GeometryError
from melt.geometry.materials import heater_table, material_table
from melt.geometry.nozzles import nozzle_table
from melt.geometry.shapes import affordable, keys, sample
from melt.geometry.walls import beyond_walls, wall_cells
from melt.physics.phases import AIRBORNE, DRIVEN, INACTIVE, LIQUID, SOLID, WALL
from melt.slime.build import in_plane, slime_arrays, spare_nodes


@dataclass
class Initial:
    """Arrays of a scene at t = 0 and what else a run needs to know of its geometry.

    Particles stand in the order liquid, solid, wall, inactive slots. All but inflow stand on one
    lattice, so two are either in the same cell (refused, or removed with a note) or a spacing apart.
    """

    arrays: dict  # by field name
    spacing: float  # dx [m]
    domain_lower: np.ndarray  # inside the walls [m]
    domain_upper: np.ndarray
    materials: list  # names of the material rows
    bodies: list  # names of the bodies (values of site_body)
    nozzles: list  # `melt.geometry.nozzles.Nozzle`
    notes: list = field(default_factory=list)  # what was moved, rounded or removed

    def __getitem__(self, name):
        return self.arrays[name]

    def __contains__(self, name):
        return name in self.arrays

    @property
    def counts(self):
        """Return {phase name: particles}; "inactive" are slots that the inflow will fill."""
        phase = self.arrays["phase"]
        names = {"liquid": LIQUID, "airborne": AIRBORNE, "solid": SOLID, "wall": WALL, "driven": DRIVEN, "inactive": INACTIVE}
        return {name: int((phase == number).sum()) for name, number in names.items()}

    @property
    def active(self):
        """Particles at the start: the first slots, in this number."""
        return int((self.arrays["phase"] != INACTIVE).sum())

    @property
    def top_speed(self):
        """Largest speed of a liquid or solid particle at the start [m/s]; the first step is laid out for it."""
        mobile = np.isin(self.arrays["phase"], (LIQUID, SOLID))
        return float(np.linalg.norm(self.arrays["velocity"][:, mobile], axis=0).max(initial=0.0))


def build(scene):
    """Sample the geometry of a scene and return its `Initial` state.

    Raises:
        GeometryError: bodies overlap each other or the walls, a mesh cannot be used.
        SceneError: solids that share a material differ in its values.
    """
    if scene.kind == "flood":
        from melt.flood.build import build_flood

        return build_flood(scene)
    notes = []
    walls, moving = _walls(scene, notes)
    fixed = np.hstack([walls, *moving])
    solids = _solids(scene, fixed, notes)
    fills = _fills(scene, fixed, solids, notes)
    table, names, rows = material_table(scene)
    nozzles, inflow = nozzle_table(scene)
    _free(scene, nozzles, inflow["inflow_position"], np.hstack([fixed, *solids]))
    spare = entering = sum(n.layers * n.count for n in nozzles)
    affordable(spare, "inflow, layers times particles of a layer")
    spare += spare_nodes(scene, sum(cells.shape[1] for cells in fills))
    bubbles, vapour = slots_of(scene, sum(cells.shape[1] for cells in fills))
    affordable(bubbles + vapour, "boiling, slots for bubbles and vapour")
    spare += bubbles + vapour
    arrays = _particles(scene, fills, solids, fixed, spare, rows, table)
    if scene.incompressible:
        arrays.update(slime_arrays(scene, arrays, _slices(arrays, walls, moving), entering))
    arrays.update(_sites(scene, solids, arrays, notes))
    arrays.update(table)
    if scene.heat is not None:
        arrays.update(heater_table(scene.heat))
    if nozzles:
        arrays.update(inflow)
    lower = np.array(scene.domain.lower, float)
    upper = lower + np.array(scene.domain.cells) * scene.spacing
    bodies = [solid.name for solid in scene.solid]
    bodies += [f"nucleus {k}" for k in range(arrays["nucleus_sites"].shape[1])]
    return Initial(arrays, scene.spacing, lower, upper, names, bodies, nozzles, notes)


def _walls(scene, notes):
    """Cells of walls with fixed obstacles, and of each moving obstacle; an obstacle may stand in a wall."""
    names = [o.name or f"obstacle {k}" for k, o in enumerate(scene.obstacle)]
    sampled = [in_plane(sample(o, scene.domain, name, notes), scene, name) for o, name in zip(scene.obstacle, names)]
    cells = [wall_cells(scene.domain), *(c for c, o in zip(sampled, scene.obstacle) if not o.moves)]
    cells = np.hstack(cells)
    first = np.unique(keys(cells), return_index=True)[1]
    walls = cells[:, np.sort(first)]
    moving, taken = [], keys(walls)
    for c in (c for c, o in zip(sampled, scene.obstacle) if o.moves):
        moving.append(c[:, ~np.isin(keys(c), taken)])
        taken = np.concatenate([taken, keys(c)])
    return walls, moving


def _slices(arrays, walls, moving):
    """Return the slice of particles of each moving body: they stand behind the walls."""
    first, slices = int(np.isin(arrays["phase"], (LIQUID, SOLID)).sum()) + walls.shape[1], []
    for cells in moving:
        slices.append(slice(first, first + cells.shape[1]))
        first += cells.shape[1]
    return slices


def _solids(scene, walls, notes):
    """Cells of each solid."""
    taken = {"a wall or obstacle": keys(walls)}
    bodies = []
    for solid in scene.solid:
        name = f"solid {solid.name!r}"
        cells = in_plane(sample(solid, scene.domain, name, notes), scene, name)
        _within(cells, scene.domain, name)
        for other, theirs in taken.items():
            shared = int(np.isin(keys(cells), theirs).sum())
            if shared:
                raise GeometryError(
                    f"{name} stands in {other} with {shared} of its {cells.shape[1]} particles: move it"
                )
        taken[name] = keys(cells)
        bodies.append(cells)
    return bodies


def _fills(scene, walls, solids, notes):
    """Cells of each liquid region, without those that something else takes."""
    obstacles, bodies = keys(walls), keys(np.hstack([np.zeros((3, 0), np.int64), *solids]))
    filled, fills = np.zeros(0, np.int64), []
    for k, fill in enumerate(scene.fluid.fill):
        name = f"fluid.fill {k}"
        cells = in_plane(sample(fill, scene.domain, name, notes), scene, name)
        mine = keys(cells)
        hit, again = np.isin(mine, obstacles) | np.isin(mine, bodies), np.isin(mine, filled)
        if hit.any():
            notes.append(
                f"{name}: removed {int(hit.sum())} liquid particles closer than 0.9 dx to a solid or wall"
            )
        if (again & ~hit).any():
            notes.append(
                f"{name}: removed {int((again & ~hit).sum())} liquid particles that an earlier region has"
            )
        cells = cells[:, ~(hit | again)]
        _within(cells, scene.domain, name)
        filled = np.concatenate([filled, keys(cells)])
        fills.append(cells)
    return fills


def _within(cells, domain, name):
    for side, count in beyond_walls(cells, domain).items():
        raise GeometryError(
            f"{name} reaches through the wall {side} with {count} particles: move it, or enlarge the domain "
            f"(now {domain.lower} to {domain.upper} m)"
        )


def _free(scene, nozzles, position, taken):
    """Refuse nozzles that stand outside, in a wall or in a body."""
    cells = np.floor((position - np.array(scene.domain.lower)[:, None]) / scene.spacing).astype(np.int64)
    inside = np.isin(keys(cells), keys(taken))
    for nozzle in nozzles:
        mine = slice(nozzle.first, nozzle.first + nozzle.count)
        _within(cells[:, mine], scene.domain, f"inflow {nozzle.name!r}")
        if inside[mine].any():
            raise GeometryError(f"inflow {nozzle.name!r} stands in a solid, wall or obstacle: move it")


def _particles(scene, fills, solids, walls, spare, rows, table):
    """Arrays over particles."""
    dx, fluid, heat = scene.spacing, scene.fluid, scene.heat
    wall_temperature = (
        fluid.temperature if heat is None or heat.wall_temperature is None else heat.wall_temperature
    )
    # (cells, phase, material, velocity, temperature) of each group, in the order of the arrays
    groups = [
        (c, LIQUID, 0, f.velocity, fluid.temperature if f.temperature is None else f.temperature)
        for c, f in zip(fills, fluid.fill)
    ]
    groups += [(c, SOLID, row, s.velocity, s.temperature) for c, s, row in zip(solids, scene.solid, rows)]
    groups += [(walls, WALL, 0, (0, 0, 0), wall_temperature)]
    # inactive slots wait at the domain's corner: no stage reads their place
    groups += [(np.zeros((3, spare), np.int64), INACTIVE, 0, (0, 0, 0), fluid.temperature)]
    size = [g[0].shape[1] for g in groups]
    material = np.repeat(np.array([g[2] for g in groups], np.int32), size)
    phase = np.repeat(np.array([g[1] for g in groups], np.int32), size)
    used = phase != INACTIVE
    cells = np.hstack([g[0] for g in groups])
    arrays = {
        "id": np.arange(sum(size), dtype=np.int32),
        "phase": phase,
        "material": material,
        "site": np.full(sum(size), -1, np.int32),
        "position": np.array(scene.domain.lower)[:, None] + (cells + 0.5) * dx,
        "velocity": np.repeat(np.array([g[3] for g in groups], float).T, size, axis=1),
        "mass": np.where(used, table["material_density"][material] * scene.particle_volume, 0.0),
        "rest_volume": np.where(used, scene.particle_volume, 0.0),
    }
    if heat is not None or scene.boiling is not None:
        arrays["temperature"] = np.repeat(np.array([g[4] for g in groups], float), size)
    return arrays


def _sites(scene, solids, arrays, notes):
    """Arrays over lattice sites, and the field ``site`` of solid particles."""
    solid = np.flatnonzero(arrays["phase"] == SOLID).astype(np.int32)
    arrays["site"][solid] = np.arange(len(solid), dtype=np.int32)
    vacant = _vacant(scene, solids)
    cells = [np.hstack([c, v]) for c, v in zip(solids, vacant)]
    # all live sites first (in the order of their particles), then the vacant ones
    live = np.concatenate(
        [np.zeros(0, bool), *(np.arange(c.shape[1]) < s.shape[1] for c, s in zip(cells, solids))]
    )
    order = np.concatenate([np.flatnonzero(live), np.flatnonzero(~live)])
    # the body's own origin is a lattice point near its middle: rest positions stay small and exact
    origin = [np.floor(c.mean(axis=1)).astype(np.int64) if c.size else np.zeros(3, np.int64) for c in solids]
    rest = [scene.spacing * (c - o[:, None]) for c, o in zip(cells, origin)]
    body = np.concatenate(
        [np.zeros(0, np.int32), *(np.full(c.shape[1], b, np.int32) for b, c in enumerate(cells))]
    )
    # spare bodies for nucleation come last, in voxels of their own
    block, spare = _nuclei(scene, len(order))
    count = spare.shape[1]
    particle = np.full(len(order) + count * block.shape[1], -1, np.int32)
    particle[: len(solid)] = solid
    own = np.hstack([np.zeros((3, 0), np.int64), *cells])[:, order]
    origins = np.hstack([np.zeros((3, 0)), *rest])[:, order]
    return {
        "site_particle": particle,
        "site_cell": np.hstack([own, np.tile(block, count)]).astype(np.int32),
        "site_rest": np.hstack([origins, scene.spacing * np.tile(block, count)]),
        "site_body": np.concatenate([body[order], len(solids) + np.repeat(np.arange(count), block.shape[1])]).astype(
            np.int32
        ),
        "nucleus_sites": spare,
    }


def _nuclei(scene, first):
    """Return the voxels of a spare body, around its middle, and the sites (2, b) of each: first, last + 1."""
    count, reach = (0, 0) if scene.heat is None else (scene.heat.nuclei, scene.heat.freeze_layers)
    affordable(max(1, count) * (2 * reach + 1) ** 3, "heat.nuclei, sites kept for them, (2 heat.freeze_layers + 1)^3 each")
    block = np.indices((2 * reach + 1,) * 3).reshape(3, -1) - reach
    start = first + block.shape[1] * np.arange(count)
    return block, np.stack([start, start + block.shape[1]]).astype(np.int32)


def _vacant(scene, solids):
    """Cells around each body that liquid may freeze to; a cell between two bodies goes to the first."""
    heat = scene.heat
    if heat is None or not heat.refreeze or heat.freeze_layers == 0:
        return [np.zeros((3, 0), np.int64) for _ in solids]
    reach = heat.freeze_layers
    affordable(max((cells.shape[1] for cells in solids), default=0) * (2 * reach + 1) ** 3, "heat.freeze_layers, sites around a body")
    offsets = np.indices((2 * reach + 1,) * 3).reshape(3, -1) - reach
    taken = keys(np.hstack([np.zeros((3, 0), np.int64), *solids]))
    found = []
    for cells in solids:
        around = (cells[:, :, None] + offsets[:, None, :]).reshape(3, -1)
        around = around[:, np.unique(keys(around), return_index=True)[1]]
        around = around[:, ~np.isin(keys(around), taken)]
        taken = np.concatenate([taken, keys(around)])
        found.append(around)
    return found
