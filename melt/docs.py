"""Write ``docs/stages.md`` from the registry and ``docs/scenes.md`` from the plans: ``python -m melt.docs``."""

import pathlib

from melt import costs
from melt.fields import EXTENTS, FIELDS
from melt.stages import STAGES

DOCS = pathlib.Path(__file__).parent.parent / "docs"
PAGE, SCENES = DOCS / "stages.md", DOCS / "scenes.md"


def _array(name):
    """Return a field with its unit."""
    if name not in FIELDS:  # source and target of the reordering stages
        return f"`{name}`"
    unit = FIELDS[name].unit
    return f"`{name}`" if unit == "1" else f"`{name}` [{unit}]"


def _tolerance(stage):
    t = stage.tolerance
    if t.single == t.double == 0:
        return f"exact: {t.reason}"
    return f"{t.single:g} single, {t.double:g} double: {t.reason}"


def _entry(stage):
    """Return the lines of one stage."""
    kept = " (a subset of the elements)" if stage.partial else ""
    lines = [
        f"### {stage.name}",
        "",
        f"`melt/{{reference,cpu,cuda}}/{stage.file}.py`, {stage.equation}",
        "",
        f"- reads {', '.join(map(_array, stage.reads)) or 'nothing'}",
        f"- parameters {', '.join(f'`{p}`' for p in stage.params) or 'none'}",
        f"- writes {', '.join(map(_array, stage.writes))}{kept}",
    ]
    if stage.scratch:
        lines.append(f"- scratch {', '.join(f'`{s}`' for s in stage.scratch)}")
    return [*lines, f"- tolerance {_tolerance(stage)}", ""]


def stages_page():
    """Return the text of docs/stages.md."""
    lines = [
        "# Stages",
        "",
        "Generated from the registry (`melt/stages.py`, `melt/fields.py`) by `python -m melt.docs`.",
        "Each stage exists three times under one signature: NumPy reference, CPU and CUDA. Tolerances are",
        "relative to the reference value and, by the same number unless said otherwise, to the natural scale",
        "of the field; `melt check` measures the errors. A field that is read and written stands under both.",
        "",
    ]
    for stage in STAGES.values():
        lines += _entry(stage)
    lines += ["## Fields", "", "| field | shape | kind | unit | meaning |", "|---|---|---|---|---|"]
    for f in FIELDS.values():
        lines.append(f"| `{f.name}` | {' x '.join(f.shape)} | {f.kind} | {f.unit} | {f.meaning} |")
    lines += ["", "## Extents", "", "| extent | counts |", "|---|---|"]
    lines += [f"| {name} | {meaning} |" for name, meaning in EXTENTS.items()]
    return "\n".join(lines) + "\n"


def main():
    """Write the pages."""
    PAGE.write_text(stages_page())
    SCENES.write_text(costs.page(SCENES.read_text() if SCENES.exists() else ""))


if __name__ == "__main__":
    main()
