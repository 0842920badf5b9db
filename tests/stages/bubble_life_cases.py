"""Pools of particles for the birth, merging and bursting of bubbles: no neighbour lists, a grid, the lists of a page."""

import numpy as np
from bubble_cases import BOILING, BUBBLES
from liquid_cases import REALS
from pbf_cases import D

from melt import params as P
from melt.check.compare import run_stage
from melt.fields import FIELDS
from melt.stages import STAGES
from melt.state import dtype_of, shape_of

LIQUID, SOLID, WALL, BUBBLE, VAPOUR, INACTIVE = range(6)
CELL = 2.5 * D
GRID = dict(origin_x=0.0, origin_y=0.0, origin_z=0.0, inverse_cell=1 / CELL, nx=8, ny=7, nz=9)
KINDS = dict(bubbles=(P.Bubbles, BUBBLES), boiling=(P.Boiling, BOILING), grid=(P.Grid, GRID))
FILES = ("lists", "bubble_birth", "bubble_growth", "bubble_merge", "bubble_burst", "condense", "grid")
UNSET = -987654321


def pool(x, phase, precision="double", **fields):
    """Return the fields of these stages for particles at x (n, 3); what is not given is 0."""
    x = np.asarray(x, float).reshape(-1, 3)
    n = len(x)
    given = {"position": x.T, "phase": np.broadcast_to(phase, n), "id": np.arange(n), **fields}
    cells = GRID["nx"] * GRID["ny"] * GRID["nz"] + 2
    sizes = dict(particle=n, cell=cells, chunk=1 + max(n, cells) // 256, reduction=64, column=GRID["nx"] * GRID["ny"], site=0)
    a = {}
    names = {name for stage in STAGES.values() if stage.file in FILES for name in stage.reads + stage.writes}
    names |= {f"{what}_{part}" for what in ("bubble", "free", "birth", "burst") for part in ("index", "count")}
    for name in sorted(names & set(FIELDS)):
        value = given.get(name)
        value = np.zeros(shape_of(FIELDS[name], sizes)) if value is None else value
        a[name] = np.ascontiguousarray(value, dtype=dtype_of(FIELDS[name], precision))
    return a


def bubbles(x, r, precision="double", **fields):
    """Return a pool of bubbles at x (n, 3) of radius r, old enough to merge, one quarter each; none of them grew."""
    x = np.asarray(x, float).reshape(-1, 3)
    r = np.broadcast_to(np.asarray(r, float), len(x))
    r = r.astype(REALS[precision][0])
    V = 4 / 3 * np.pi * r.astype(float) ** 3
    n = len(x)
    given = dict(bubble_radius=r, bubble_volume=V, rest_volume=V, age=np.full(n, 0.2), cargo=np.ones(n))
    return pool(x, BUBBLE, precision, **{**given, **fields})


def params_of(stage, real, changes):
    """Return the parameters of a stage; keywords change entries of tuples or are scalars."""
    found = {}
    for name in STAGES[stage].params:
        if name in KINDS:
            kind, values = KINDS[name]
            found[name] = P.make(kind, real, **{**values, **{k: v for k, v in changes.items() if k in values}})
        else:
            value = changes[name]
            found[name] = np.int32(value) if isinstance(value, int) else real(value)
    return found


def run(stage, backend, a, names=None, **changes):
    """Run a stage, put what it writes into ``a`` and return that; ``names`` maps arguments to other fields."""
    names = names or {}
    there = {name: a[names.get(name, name)] for name in STAGES[stage].arguments if names.get(name, name) in a}
    out = run_stage(stage, backend, there, params_of(stage, a["mass"].dtype.type, changes))
    out = {names.get(name, name): value for name, value in out.items()}
    a.update(out)
    return out


def listed(backend, a, flag, key, name, ordered=True):
    """List the slots with flag == key as the page does; return them."""
    a[f"{name}_index"][:] = UNSET
    names = dict(flag=flag, index=f"{name}_index", count=f"{name}_count")
    run("list_slots", backend, a, names, key=key)
    if ordered:
        run("order_by_id", backend, a, names)
    return a[f"{name}_index"][: a[f"{name}_count"][0]]


def merge(backend, a, coarse=None, **changes):
    """List the bubbles and merge them once, as the page does."""
    listed(backend, a, "phase", BUBBLE, "bubble")
    coarse = coarse or max(1, int(np.ceil(2.001 * float(a["bubble_radius"].max(initial=0)) / CELL)))
    run("bubble_cell", backend, a, coarse=coarse)
    run("cell_sort", backend, a, dict(cell="bubble_cell", order="bubble_order", cell_start="bubble_start"))
    run("merge_label", backend, a, coarse=coarse, **changes)
    return run("merge_bubbles", backend, a, **changes)


def slots_of(a, phase):
    return np.flatnonzero(a["phase"] == phase)


def same_bits(first, second, fields):
    """Return whether the two pools hold the same particles, by id, in all bits of the fields."""
    one, two = np.argsort(first["id"]), np.argsort(second["id"])
    return all(
        np.ascontiguousarray(first[f][..., one]).tobytes() == np.ascontiguousarray(second[f][..., two]).tobytes() for f in fields
    )


def shuffled(a, order):
    """Return the pool with its particles in other slots."""
    n = len(a["phase"])
    return {name: v[..., order].copy() if v.ndim and v.shape[-1] == n else v.copy() for name, v in a.items()}
