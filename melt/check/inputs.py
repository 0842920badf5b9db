"""Inputs of every stage for the cross-check: one consistent random scene, cut to what a stage reads.

`make` gives arrays, parameter tuples and scales; `choices` lists the variants of a stage (smoothing
functions, laws, region widths, an empty scene ...), each of which is checked. A stage that reads
something nobody described here is an error that names it, never a silent zero.
"""

from functools import lru_cache

import numpy as np

from melt import params as P
from melt.check import (
    _boiling,
    _cloud,
    _flood,
    _flood_values,
    _pbf,
    _screen,
    _sites,
    _slime,
    _slime_apic,
    _slime_ghosts,
    _slime_motion,
    _slime_solve,
    _thermal,
)
from melt.check._choices import EXTRA, LEAST, SCALARS, SMALL, SWITCHES, TUPLES
from melt.check._fields import particle_fields, special_fields
from melt.fields import FIELDS
from melt.stages import STAGES
from melt.state import REAL, dtype_of

#: Stages that bring particles into cell order: their input is not in it.
_UNORDERED = {
    "cell_index",
    "cell_sort",
    "reorder_scalar",
    "reorder_vector",
    "site_particle",
    "kdtree_build",
    "neighbours_kdtree",
}


class UnknownInput(KeyError):
    """A stage reads something that the check inputs do not describe."""

    def __str__(self):
        return self.args[0]


def _of_flood(stage):
    return stage.file.startswith("flood")


def scales(n):
    """Return the natural scales of fields: typical magnitudes in the check scene."""
    volume, speed, pressure = _cloud.SPACING**3, 2.0, 1000 * 20.0**2 / 7 * 0.5
    mass = 1000 * volume
    return dict(
        spacing=_cloud.SPACING,
        speed=speed,
        mass=mass,
        volume=volume,
        density=1000.0,
        pressure=pressure,
        force=pressure * volume / _cloud.SPACING,
        temperature=50.0,
        conductivity=4e7,
        conductance=4e5,
        heat_capacity=mass * 4187.0,
        latent_energy=mass * 3e4,
        heat=mass * 3e4,
        number_density=1 / volume,
        one=1.0,
        mobility=1 / mass,
        multiplier=0.05 / _pbf.D0,
        rate=speed / _cloud.SPACING,
        rate2=(speed / _cloud.SPACING) ** 2,
        acceleration=pressure / 1000 / _cloud.SPACING,
        time=1.0,
        momentum=mass * speed,
        bubble_push=mass * speed * volume,
        specific_heat=4187.0,
        latent_heat=3e4,
        **_slime.SCALES,
        **{name: _flood_values.SCALES[name] for name in ("depth", "area", "curvature", "flux")},
    )


@lru_cache(maxsize=16)
def scene(n, seed, ordered, width, connect):
    """Return (arrays, grid) of the whole check scene in float64 and int64. Do not write to it."""
    arrays, grid, rng = _cloud.cloud(n, seed, ordered)
    arrays.update(particle_fields(arrays, scales(n), rng))
    _sites.sites(n, arrays, rng, width, connect)
    arrays.update(special_fields(arrays, rng))
    arrays.update(_pbf.fields(arrays, rng))
    arrays.update(_boiling.fields(arrays, rng))
    arrays.update(_screen.fields(arrays, np.random.default_rng(seed + 2)))
    for array in arrays.values():
        array.flags.writeable = False
    return arrays, grid


@lru_cache(maxsize=8)
def flood_scene(n, seed):
    """Return (arrays, grid) of the check scene of stages of the flood. Do not write to it."""
    arrays, grid = _flood.scene(n, seed)
    for array in arrays.values():
        array.flags.writeable = False
    return arrays, grid


def _params(stage, real, grid, choice):
    found = {}
    values_of = {**SCALARS, **_flood_values.SCALARS} if _of_flood(stage) else SCALARS
    for name in stage.params:
        if name in TUPLES:
            kind, values = TUPLES[name]
            values = dict(grid) if name == "grid" else dict(values)
            if name == "heat" and choice.get("law", P.HEAT_PHYSICAL) == P.HEAT_PAPER:
                values["ambient_transfer"] *= 2.5e-7  # m/s: divided by density and specific heat
            values.update({k: v for k, v in choice.items() if k in values})
            found[name] = P.make(kind, real, **values)
        elif name in values_of:
            value = choice.get(name, values_of[name])
            found[name] = np.int32(value) if isinstance(value, int) else real(value)
        else:
            raise UnknownInput(
                f"stage {stage.name}: no check input for parameter {name!r} (melt/check/_choices.py)"
            )
    return found


def _sizes(arrays, grid):
    """Return the size of every extent in the check scene."""
    if "terrain" in arrays:
        return _flood.sizes(arrays)
    n, cells = len(arrays["phase"]), grid["nx"] * grid["ny"] * grid["nz"] + 2
    return dict(
        particle=n,
        node=n,
        neighbour=arrays["neighbour_index"].shape[1],
        cell=cells,
        chunk=-(-max(n, cells) // 256),
        site=len(arrays["site_body"]),
        link=27,
        region=arrays["site_region"].shape[1],
        material=len(arrays["material_density"]),
        surface_node=arrays["surface_node"].shape[1],
        heater=len(arrays["heater_shape"]),
        inlet=len(arrays["inflow_mass"]),
        nucleus=arrays["nucleus_sites"].shape[1],
        reduction=64,
        table=arrays["kernel_scale"].shape[1],
        **_slime.sizes(grid),
        bin=len(arrays["height_bins"]),
        column=grid["nx"] * grid["ny"],
        voxel=_boiling.VOXELS,
        **_screen.SIZES,
    )


def _generic(stage, field, sizes, all_scales, rng):
    """A field nobody computed: zeros if only written, else random reals; no random index is harmless."""
    unknown = [e for e in field.shape if not e.isdigit() and e not in sizes]
    only_written = field.name in stage.writes and field.name not in stage.reads
    if unknown or (field.kind == "int" and not only_written):
        raise UnknownInput(
            f"stage {stage.name}: no check input for field {field.name!r} (melt/check/_fields.py)"
        )
    shape = tuple(int(e) if e.isdigit() else sizes[e] for e in field.shape)
    return (
        np.zeros(shape) if only_written else rng.uniform(0.5, 1.5, shape) * all_scales.get(field.scale, 1.0)
    )


def _array(stage, name, arrays, grid, choice, all_scales, rng):
    """Return (values, kind) of one array argument."""
    if name in ("source", "target"):
        if choice.get("kind") == "int":
            return rng.integers(-9, 9, arrays["phase"].shape), "int"
        return (arrays["velocity"] if stage.name.endswith("vector") else arrays["mass"]) + 0.0, "real"
    if name in _boiling.NAMED:
        return arrays[name], "int"
    field = FIELDS[name]
    if name in ("neighbour_count", "neighbour_index") and "capacity" in choice and not _of_flood(stage):
        rows = _cloud.neighbour_rows(arrays["position"].T, arrays["phase"])
        return _cloud.padded(rows, choice["capacity"])[name == "neighbour_index"], field
    if name in arrays:
        if stage.partial and name in stage.writes and name not in stage.reads and field.kind != "int":
            # elements that the stage must write start from something else than the right answer
            return 0.75 * arrays[name] + 0.1 * all_scales.get(field.scale, 1.0), field
        return arrays[name], field
    return _generic(stage, field, _sizes(arrays, grid), all_scales, rng), field


def _adapted(stage_name, arrays, grid, choice):
    """Return the scene as it is when the stage runs, and as its variant asks."""
    if _of_flood(STAGES[stage_name]):
        return _flood.adapted(arrays, choice)
    if choice.get("bubbles", STAGES[stage_name].file in _boiling.FILES):
        arrays = _boiling.with_bubbles(arrays, grid)
    if STAGES[stage_name].file in _slime.FILES:
        arrays = {**arrays, **_slime.fields(arrays, np.random.default_rng(len(arrays["phase"])))}
        arrays = _slime_solve.adapted(arrays, choice)
        arrays = _slime_motion.adapted(STAGES[stage_name], arrays, grid, choice)
        arrays = _slime_apic.with_particles(arrays, grid, STAGES[stage_name].file, "length_x" in choice)
    if STAGES[stage_name].file in _slime_ghosts.FILES:
        arrays = _slime_ghosts.adapted(arrays, grid, choice)
    if stage_name == "boiled_sums":
        arrays = _boiling.with_unequal_masses(arrays)
    if stage_name == "fill_regions":
        arrays = _sites.after_melting(arrays)
    if stage_name == "mark_frozen":
        arrays = _sites.after_freezing(arrays, choice.get("connect", 26))
    if stage_name == "region_match":
        arrays = _sites.warm_start(arrays)
    if choice.get("law", P.HEAT_PHYSICAL) == P.HEAT_PAPER:
        arrays = _thermal.in_paper_mode(arrays)
    if choice.get("wall_fixed"):
        arrays = _thermal.with_fixed_walls(arrays)
    if choice.get("temperature") == 0:  # a scene without heat has no such field
        arrays = {**arrays, "temperature": np.zeros(0)}
    return arrays


def make(stage_name, precision, n=301, seed=0, choice=None):
    """Return (arrays, params, scales) with which stage ``stage_name`` can be run.

    Args:
        precision: ``single``, ``mixed`` or ``double``.
        n: particles, inactive slots included; bodies need 150, extremes (coincident, isolated ...) 40.
        choice: one of `choices(stage_name)`, e.g. ``{"kernel": 1}``.
    """
    stage, choice, real = STAGES[stage_name], choice or {}, REAL[precision]
    n = choice.get("n", n)
    width, connect = choice.get("width", 2), choice.get("connect", 26)
    flood = _of_flood(stage)
    arrays, grid = flood_scene(n, seed) if flood else scene(n, seed, stage_name not in _UNORDERED, width, connect)
    arrays = _adapted(stage_name, arrays, grid, choice)
    rng = np.random.default_rng(seed + 1)
    all_scales = {**scales(n), **_flood_values.SCALES} if flood else scales(n)
    cast = {}
    for name in stage.arguments:
        if name in stage.params:
            continue
        array, field = _array(stage, name, arrays, grid, choice, all_scales, rng)
        kind = (
            {"int": np.int32, "real": real}[field] if isinstance(field, str) else dtype_of(field, precision)
        )
        cast[name] = np.ascontiguousarray(array, dtype=kind).copy()
    _exact_thresholds(stage, cast)
    return cast, _params(stage, real, grid, choice), all_scales


def _exact_thresholds(stage, cast):
    """Put one temperature exactly at its melting point and one just below, in the run's own precision."""
    T, material, melts = (cast.get(k) for k in ("temperature", "material", "material_melting_point"))
    if T is None or material is None or melts is None:
        return
    finite = np.flatnonzero(np.isfinite(melts[material]))
    for k, i in enumerate(finite):
        if k % 5 == 0:
            T[i] = melts[material[i]]
        elif k % 5 == 1:
            T[i] = np.nextafter(melts[material[i]], T.dtype.type(-np.inf))


def choices(stage_name):
    """Return the variants of a stage: the base case, each switch's other values, none and one particle."""
    stage = STAGES[stage_name]
    found = [{}]
    for name in stage.params:
        for switch, values in SWITCHES.get(name, {}).items():
            base = TUPLES[name][1][switch]
            size = {"n": LEAST[stage_name]} if stage_name in LEAST else {}
            found += [{switch: v, **size} for v in values if v != base]
    if "wall_count" in stage.arguments:
        found.append({"walls": 0})
    small = SMALL.get(stage_name, {})
    return found + EXTRA.get(stage_name, []) + [{"n": 0, **small}, {"n": 1, **small}]
