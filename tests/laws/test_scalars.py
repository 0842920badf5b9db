"""Scalar formulas compiled for float32 return float32: one wide literal would double the cost of a kernel."""

import importlib
import inspect

import numba
import numpy as np
import pytest
from _source import modules

from melt.check.inputs import TUPLES, scales
from melt.params import make


def tuples(real):
    """Return the parameter tuples by name."""
    grid = dict(origin_x=0.0, origin_y=0.0, origin_z=0.0, inverse_cell=2.0, nx=4, ny=4, nz=4)
    return {name: make(kind, real, **(values or grid)) for name, (kind, values) in TUPLES.items()}


#: Arguments that are integers, by name.
INTEGERS = {
    "count",
    "shape",
    "kind",
    "mode",
    "connect",
    "slot",
    "phase",
    "phase_i",
    "phase_j",
    "iterations",
    "n",
    "sweeps",
    "law",
    "cell",
    "width",
    "level",
    "place",
    "i",
    "j",
    "k",
    "iteration",
    "first",
    "second",
    "row",
    "id",
    "step_low",
    "step_high",
    "number",
    "seed_low",
    "seed_high",
    "stream",
    "coarse",
    "steps",
    "column",
    "across",
    "c_x",
    "c_y",
    "c_z",
}
#: Words of a random generator: uint64.
WORDS = {"c0", "c1", "c2", "c3", "k0", "k1"}
#: Arguments that are arrays: shape and kind, None for that of the other reals.
ARRAYS = {"support_radius": (4, None), "kernel_scale": ((3, 65), None), "pbf.iterations": (4, np.int32)}
ARRAYS |= {"boiling.heat_sum": (4, None), "boiling.constraint": (4, None), "boiling.voxel_temperature": (60, None)}
#: The list of bubbles, and what merging reads of them.
ARRAYS |= {f"bubble_life.{name}": (4, np.int32) for name in ("bubble_index", "bubble_count", "merge_root", "merge_size", "cargo")}
ARRAYS |= {f"bubble_life.{name}": (4, None) for name in ("bubble_volume", "bubble_radius")}
ARRAYS |= {f"bubble_life.{name}": ((3, 4), None) for name in ("position", "velocity")}
#: Lattice points of ghosts.
ARRAYS |= {"ghosts.ghost_state": (4096, np.int32), "viscous.viscous_block": ((6, 4), None)}
#: Node fields of a terrain grid.
ARRAYS |= {"terrain.terrain": (99, None), "terrain.field": (99, None), "flood_motion.terrain_wall": (99, None)}
ARRAYS |= {"flood_forces.terrain": (99, None), "flood_control.terrain": (99, None)}
#: Pictures, and colour maps, of the screen-space renderer.
ARRAYS |= {f"screen_light.{name}": ((5, 6), None) for name in ("image", "behind_depth", "screen_map")}
ARRAYS |= {f"screen_light.{name}": ((3, 5, 6), None) for name in ("screen_value", "behind_colour")}
#: Arguments that are tuples of numbers, by (module.function, argument): how many.
NUMBERS = {
    ("polar.horn", "A"): 9,
    ("polar.horn", "q"): 4,
    ("polar.svd", "A"): 9,
    ("polar.svd", "q"): 4,
    ("polar.iterative", "A"): 9,
    ("polar.iterative", "q"): 4,
    ("polar.rotation", "A"): 9,
    ("polar.rotation", "q"): 4,
    ("polar._turn4", "p"): 4,
    ("polar._turn4", "q"): 4,
    ("polar._turn3", "p"): 3,
    ("polar._turn3", "q"): 3,
    ("polar._add_if", "total"): 4,
    ("polar._add_if", "v"): 4,
    ("polar._add_if", "q"): 4,
    ("polar.eigen", "J"): 6,
    ("apic.pseudo_inverse", "D"): 6,
    ("apic._product", "A"): 9,
    ("apic._product", "B"): 9,
    ("apic.deformation", "C"): 9,
    ("apic.relaxed", "C"): 9,
    ("apic.relaxed", "b"): 6,
    ("apic.pull", "b"): 6,
    ("apic.pull", "D"): 6,
    ("apic.about_centre", "m"): 3,
    ("apic.about_centre", "D"): 6,
    ("polar.solve_inertia", "J"): 6,
    ("polar.solve_inertia", "L"): 3,
    ("polar._dot", "a"): 3,
    ("polar._dot", "b"): 3,
    ("polar._cross", "a"): 3,
    ("polar._cross", "b"): 3,
    ("screen_light.behind", "own"): 3,
}
#: Names above that are reals all the same: an axis-angle or matrix written out, coordinates.
REALS = {("quaternion.from_matrix", "i"), ("search.precedes", "x"), ("search.precedes", "y")}


def values(name, parameters, real):
    """Return float arguments for a scalar formula: small numbers, so that no branch overflows."""
    found = []
    for k, parameter in enumerate(parameters):
        if parameter in tuples(real):
            found.append(tuples(real)[parameter])
        elif parameter in WORDS:
            found.append(np.uint64(7))
        elif parameter in ARRAYS or f"{name.split('.')[0]}.{parameter}" in ARRAYS:
            shape, kind = ARRAYS.get(parameter) or ARRAYS[f"{name.split('.')[0]}.{parameter}"]
            found.append(np.full(shape, 0.4).astype(kind or real))
        elif parameter in INTEGERS and (name, parameter) not in REALS:
            found.append(np.int32(1))
        elif (name, parameter) in NUMBERS:
            found.append(tuple(real(0.2 + 0.1 * i + 0.3 * (i % 3)) for i in range(NUMBERS[name, parameter])))
        else:
            found.append(real(0.2 + 0.01 * k))
    return found


def scalars():
    """Yield (module.function, dispatcher) of every compiled function of `melt.physics`."""
    for path in modules("physics"):
        if path.stem == "__init__":
            continue
        module = importlib.import_module(f"melt.physics.{path.stem}")
        for name, value in vars(module).items():
            if hasattr(value, "py_func") and value.py_func.__module__ == module.__name__:
                yield f"{path.stem}.{name}", value


SCALARS = dict(scalars())


def inferred(dispatcher, arguments):
    """Return the types that numba inferred for the result of a call with these arguments."""

    def leaves(kind):
        if hasattr(kind, "types"):  # a tuple of different types
            return [leaf for part in kind.types for leaf in leaves(part)]
        return leaves(kind.dtype) * kind.count if hasattr(kind, "count") else [str(kind)]

    kinds = tuple(numba.typeof(a) for a in arguments)
    return leaves(dispatcher.overloads[kinds].signature.return_type)


def test_there_are_scalars():
    assert len(SCALARS) > 10


@pytest.mark.parametrize("name", SCALARS)
@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_scalar_keeps_the_precision_of_its_arguments(name, real):
    dispatcher = SCALARS[name]
    parameters = list(inspect.signature(dispatcher.py_func).parameters)
    arguments = values(name, parameters, real)
    try:
        dispatcher(*arguments)
    except Exception as error:
        pytest.fail(
            f"{name}{tuple(parameters)}: no arguments known for it in tests/laws/test_scalars.py, or it "
            f"does not compile: {type(error).__name__}: {str(error).splitlines()[0]}"
        )
    other = "float64" if real is np.float32 else "float32"
    kinds = inferred(dispatcher, arguments)
    assert other not in kinds, f"{name} returns {kinds}"


def test_the_law_catches_a_wide_literal():
    from melt._compile import scalar

    @scalar
    def wide(r):
        return 0.5 * r

    wide(np.float32(0.2))
    assert inferred(wide, [np.float32(0.2)]) == ["float64"]


def test_scales_cover_every_field():
    from melt.fields import FIELDS

    known = scales(301)
    assert {f.scale for f in FIELDS.values() if f.scale} <= set(known)
