"""What the law tests know about the source: parsed modules, functions, stages."""

import ast
import functools
import pathlib

from melt import stages
from melt.stages import STAGES

ROOT = pathlib.Path(stages.__file__).parent
SIDES = ("reference", "cpu", "cuda")


@functools.cache
def tree(path):
    """Return the syntax tree of a file."""
    return ast.parse(path.read_text(), str(path))


def modules(*folders):
    """Return the source files of melt, or of some of its folders."""
    return sorted(
        p for f in folders or (".",) for p in (ROOT / f).rglob("*.py") if "__pycache__" not in p.parts
    )


def functions(path):
    """Return all function definitions of a file, methods included."""
    return [n for n in ast.walk(tree(path)) if isinstance(n, (ast.FunctionDef, ast.AsyncFunctionDef))]


def function(side, stage):
    """Return the syntax tree of the public function of a stage."""
    path = ROOT / side / f"{STAGES[stage].file}.py"
    found = [f for f in tree(path).body if isinstance(f, ast.FunctionDef) and f.name == stage]
    assert len(found) == 1, f"{path.relative_to(ROOT)} defines {stage} {len(found)} times"
    return found[0]


def imports(path):
    """Return the dotted names that a file imports: (module, name) with name '' for plain imports."""
    found = []
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            found += [(alias.name, "") for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            found += [("." * node.level + (node.module or ""), alias.name) for alias in node.names]
    return found


def arguments(node):
    """Return the argument names of a function definition."""
    return tuple(a.arg for a in node.args.posonlyargs + node.args.args + node.args.kwonlyargs)


def stored(node):
    """Return names whose elements a function stores to: ``x[...] = ``, ``x[...] += ``, atomics."""
    found = set()
    for n in ast.walk(node):
        targets = (
            n.targets if isinstance(n, ast.Assign) else [n.target] if isinstance(n, ast.AugAssign) else []
        )
        for target in targets:
            for part in ast.walk(target):
                if isinstance(part, ast.Subscript) and isinstance(part.ctx, ast.Store):
                    base = part.value
                    while isinstance(base, (ast.Subscript, ast.Attribute)):
                        base = base.value
                    if isinstance(base, ast.Name):
                        found.add(base.id)
        if isinstance(n, ast.Call) and isinstance(n.func, ast.Attribute):
            owner = n.func.value
            if (
                isinstance(owner, ast.Attribute)
                and owner.attr == "atomic"
                and isinstance(n.args[0], ast.Name)
            ):
                found.add(n.args[0].id)
    return found
