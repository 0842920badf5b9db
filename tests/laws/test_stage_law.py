"""A stage exists three times, under one signature, and writes what the registry says."""

import ast
import inspect

import pytest
from _source import ROOT, SIDES, arguments, function, stored, tree

from melt.check.compare import stage_function
from melt.fields import EXTENTS, FIELDS
from melt.stages import STAGES

#: Files whose stages may have more than 12 arguments, and why.
LONG = {
    "heat": "enthalpy curves: point, latent capacity and both heat capacities come with the temperature",
    "heat_source": "as heat",
    "heat_coloured": "as heat",
    "heat_explicit": "as heat",
    "heat_balance": "as heat",
    "force": "both partners' mechanical state, and the pressure that walls carry",
    "load": "of a pressure: what the liquid and walls at rest have, beside the operator of the solve",
    "contact": "pairs of one body are skipped by lattice distance, which needs its sites beside the motion",
    "freezing": "a liquid particle is matched with sites, regions and the material it freezes to at once",
    "pbf": "both partners' share in the solve, the lists, and which of the pairs act in an iteration",
    "pbf_solid": "the push of the solve and contact at once: both partners, the lists, and which body a particle is of",
    "bubble_motion": "drag: the list of bubbles beside that of their neighbours",
    "vapour": "a particle that comes into being: all its fields",
    "condense": "a particle that comes into being: all its fields",
    "bubble_birth": "one particle becomes four bubbles: all their fields",
    "bubble_merge": "the list of bubbles, their cells and their state; a merged bubble's whole state",
    "boil_heat": "heat exchange of pairs: what (10) weighs by beside what (11) weighs by, so that one stage serves both",
    "flood_entry": "a column that comes into being: all its fields",
    "flood_depth": "the coupled solve of depth and support takes walls with it",
    "flood_sample": "what four means of the water are made of, where, and what is kept of them",
    "apic_nodes": "a node's whole state from the whole state of APIC particles, their weights and their cells",
    "apic_back": "as apic_nodes, the other way round, with gravity for orphans",
    "apic_stress": "as apic_nodes, with the strain",
    "apic_emit": "a particle that comes into being: all its fields",
    "rigid": "both the sites and the motion of a body and of its particles",
    "flood_force": "both partners' state, two supports of a pair, and the slope under the column",
    "viscous": "the right-hand side of the viscous solve: both velocities, both pressures, and the pairs",
    "poisson": "the right-hand side of the pressure solve: motion, matrix and first guess",
    "flood_balanced": "as flood_force, with the bed of both partners, and walls and terrain in its closure",
}


@pytest.mark.parametrize("stage", STAGES)
def test_stage_exists_three_times_with_the_arguments_of_the_registry(stage):
    for side in SIDES:
        function = stage_function(stage, side)
        function = getattr(function, "py_func", function)
        found = tuple(inspect.signature(function).parameters)
        assert found == STAGES[stage].arguments, f"{side}: {found}"


@pytest.mark.parametrize("stage", STAGES)
def test_stage_stores_only_to_what_the_registry_says_it_writes(stage):
    for side in SIDES:
        node = function(side, stage)
        stray = (stored(node) & set(arguments(node))) - set(STAGES[stage].writes)
        assert not stray, f"{side}: writes {stray}"


@pytest.mark.parametrize("stage", STAGES)
def test_kernels_store_only_to_what_the_registry_says_the_stage_writes(stage):
    node = function("cuda", stage)
    kernels = {
        f.name: f
        for f in tree(ROOT / "cuda" / f"{STAGES[stage].file}.py").body
        if isinstance(f, ast.FunctionDef)
    }
    launches = [
        n
        for n in ast.walk(node)
        if isinstance(n, ast.Call)
        and isinstance(n.func, ast.Attribute)
        and n.func.attr == "launch"
        and isinstance(n.func.value, ast.Name)
    ]
    for call in launches:
        kernel = kernels.get(call.func.value.id)
        if kernel is None:  # imported from a private file, whose arguments have general names
            continue
        given = dict(zip(arguments(kernel), call.args[1:]))
        written = {given[p].id for p in stored(kernel) if p in given and isinstance(given[p], ast.Name)}
        stray = (written & set(STAGES[stage].arguments)) - set(STAGES[stage].writes)
        assert not stray, f"{kernel.name} writes {stray}"


@pytest.mark.parametrize("stage", STAGES.values(), ids=lambda s: s.name)
def test_registry_entry_is_sound(stage):
    generic = {"grid": {"source", "target"}, "lists": {"flag", "index", "count"}}.get(stage.file, set())
    for name in stage.reads + stage.writes:
        assert name in FIELDS or name in generic, name
    assert set(stage.scratch) <= set(stage.writes)
    assert len(set(stage.arguments)) == len(stage.arguments)
    assert stage.tolerance.reason and stage.equation


@pytest.mark.parametrize("stage", STAGES.values(), ids=lambda s: s.name)
def test_stage_has_at_most_twelve_arguments(stage):
    if stage.file in LONG:
        pytest.skip(f"exempt: {LONG[stage.file]}")
    assert len(stage.arguments) <= 12, stage.arguments


def test_exemptions_are_needed():
    needed = {s.file for s in STAGES.values() if len(s.arguments) > 12}
    assert set(LONG) <= needed


def test_every_public_function_of_the_twins_is_a_registered_stage():
    for side in ("cpu", "cuda"):
        for path in sorted((ROOT / side).glob("[!_]*.py")):
            for node in tree(path).body:
                if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
                    assert node.name in STAGES and STAGES[node.name].file == path.stem, (
                        f"{side}/{path.name}: {node.name}"
                    )


def test_fields_name_known_extents_and_kinds():
    for field in FIELDS.values():
        assert field.kind in ("real", "position", "double", "int")
        assert all(e.isdigit() or e in EXTENTS for e in field.shape), field
        assert field.kind == "int" or field.scale, f"{field.name} has no scale"
