"""Who may import what: the reference shares nothing with the twins, the twins share scalar formulas only."""

import ast

import pytest
from _source import ROOT, imports, modules, tree

COMPILERS = ("numba", "llvmlite")


def own(path):
    """Modules of melt that a file imports; ``from melt import x`` counts as melt.x."""
    return {
        f"melt.{name}" if module == "melt" else module
        for module, name in imports(path)
        if module == "melt" or module.startswith("melt.")
    }


@pytest.mark.parametrize("path", modules("reference"), ids=lambda p: p.name)
def test_reference_imports_nothing_from_the_twins(path):
    allowed = {m for m in own(path) if m.startswith("melt.reference._")}
    assert own(path) == allowed
    roots = {module.split(".")[0] for module, _ in imports(path)} - {"melt"}
    assert roots <= {"numpy", "scipy", "math", "itertools", "collections", "functools"}, roots


@pytest.mark.parametrize("side", ["cpu", "cuda"])
def test_twins_import_the_compile_policy_parameters_physics_and_their_own_private_files(side):
    for path in modules(side):
        for module in own(path):
            good = module in ("melt._compile", "melt.params") or module.startswith(
                ("melt.physics.", f"melt.{side}._")
            )
            assert good, f"{side}/{path.name} imports {module}"


def test_physics_imports_only_the_compile_policy_and_parameters():
    for path in modules("physics"):
        for module in own(path):
            assert module in ("melt._compile", "melt.params") or module.startswith("melt.physics."), (
                f"{path.name}: {module}"
            )


def test_only_the_compile_policy_imports_the_compilers():
    """Elsewhere numba may be asked for its version, its threads or the type of a value, and compiles nothing."""
    # the PTX report inspects what numba would compile; it defines no compiled function
    # AVX-512 packing needs an intrinsic written in LLVM: the vectoriser cannot do it
    allowed = {
        ROOT / "_compile.py",
        ROOT / "_emulate.py",
        ROOT / "check" / "ptx.py",
        ROOT / "cpu" / "_compress.py",
    }
    harmless = {
        "__version__",
        "config",
        "set_num_threads",
        "get_num_threads",
        "threading_layer",
        "version_info",
        "typeof",
    }
    for path in modules():
        if path in allowed:
            continue
        for module, name in imports(path):
            if module.split(".")[0] in COMPILERS:
                assert (module, name) == ("numba", "") or (module == "numba" and name in harmless), (
                    f"{path}: {module} {name}"
                )
        used = {
            n.attr
            for n in ast.walk(tree(path))
            if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name) and n.value.id == "numba"
        }
        assert used <= harmless, f"{path.relative_to(ROOT)} uses numba.{used - harmless}"


def test_imports_are_absolute():
    for path in modules():
        assert not [m for m, _ in imports(path) if m.startswith(".")], path


def test_melt_is_never_imported_lazily_from_the_stages():
    """Stages import at the top of the file: an import further down hides a dependency."""
    for path in modules("reference", "cpu", "cuda", "physics"):
        for line in path.read_text().splitlines():
            assert not (line.startswith(" ") and line.strip().startswith(("import ", "from melt"))), (
                f"{path.name}: {line}"
            )
