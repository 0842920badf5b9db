"""The figures that README.md shows: rows of docs/results.md, by heading and name, put between its two pairs of marks."""

#: (words for the reader, start of the section's heading, name of the row).
ERRORS = [
    ("melt front after 4 s, in spacings (Stefan)", "Heat and melting fronts", "V7 40/-10 degC at 4 s [dx]"),
    ("depth at which ice floats, share of its height", "Mechanics of melting scenes", "V13 draft fraction, 917"),
    (
        "front of a collapsing column (Martin and Moyce 1952)", "Dam break: the front",
        "V11 front, Martin & Moyce 1952, a = 2.25 in: mean relative error",
    ),
    (
        "speed of a bubble in liquid over sqrt(g r)", "Boiling: validation cases",
        "V16 speed in the liquid around over sqrt(g r), r = 0.39 d",
    ),
    ("dam break onto shallow water, L1 of depth (Stoker)", "Flood: exact solutions", "stoker, r0 = 0.1 m: L1 of depth, columns"),
    ("tsunami in a wave tank, three gauges (Monai)", "Flood, Table 2", "monai, mean relative error"),
    ("channel flow of a viscous liquid, 40 particles across", "Slime: exact solutions", "poiseuille, 40: largest L2 from 0.1 to 1 H^2/nu"),
    ("period of a swinging drop, relative error", "Slime: exact solutions", "drop, APIC: period off"),
    ("momentum of a free, spinning body", "Shape matching", "V16 angular momentum, double"),
    ("CPU against CUDA, stage by stage in a melting run", "Ledgers of melting runs", "V18 CPU and emulated CUDA in lockstep"),
]
SPEEDS = [
    ("weakly compressible SPH, a million particles", "Cost per stage", "1,000,000 liquid + 203,208 wall, 2 thread(s)"),
    ("melting paper's scene: 35,000 water, 5,000 ice", "Melting paper, Table 2", "ice_cube (35k + 5k), paper's work, grid"),
    ("position based fluid", "Position based fluid", "59,319 liquid, support 2.0, melt"),
    ("the same by SPlisHSPlasH", "Position based fluid", "59,319 liquid, support 2.0, SPlisHSPlasH"),
    ("boiling paper's tank", "Boiling paper, Table 1", "kettle, PBF"),
    ("incompressible (DFSPH), splashing", "Incompressible liquids", "59,319 liquid, 0 Pa s, melt"),
    ("the same by SPlisHSPlasH", "Incompressible liquids", "59,319 liquid, 0 Pa s, SPlisHSPlasH"),
    ("DFSPH with 50 Pa s, implicit", "Incompressible liquids", "59,319 liquid, 50 Pa s, melt"),
    ("the same by SPlisHSPlasH", "Incompressible liquids", "59,319 liquid, 50 Pa s, SPlisHSPlasH"),
    ("flood, sub-steps a second", "Flood paper, Table 3", "60,345 columns, frames/s before rendering"),
]
MARKS = "<!-- {} -->"


def fill(readme, results):
    """Return the text of README.md with both tables as the page docs/results.md has them."""
    for which, lines in (("errors", _errors(results)), ("speeds", _speeds(results))):
        begin, end = MARKS.format(which), MARKS.format(f"end of {which}")
        before, rest = readme.split(begin)
        readme = "\n".join([before + begin, *lines, end + rest.split(end)[1]])
    return readme


def _errors(results):
    """Yield lines: how many of all bounds hold, then the table."""
    yield from (line for line in results.splitlines() if line.endswith(" bounds hold."))
    yield ""
    yield "| what | expected | measured | bound | holds |"
    yield "|---|---|---|---|---|"
    for words, heading, name in ERRORS:
        _, expected, measured, bound, ok, _ = row(results, heading, name)
        yield f"| {words} | {expected} | {measured} | {bound} | {ok} |"


def _speeds(results):
    yield "| what | measured | target | holds | of |"
    yield "|---|---|---|---|---|"
    for words, heading, name in SPEEDS:
        _, _, measured, bound, ok, note = row(results, heading, name)
        yield f"| {words} | {measured} | {bound} | {ok} | {name}; {note} |"


def row(results, heading, name):
    """Return the six cells of a row of docs/results.md.

    Raises:
        KeyError: no such section or row.
    """
    parts = [part for part in results.split("\n## ")[1:] if part.startswith(heading)]
    for line in parts[0].splitlines() if parts else ():
        cells = line[2:].removesuffix(" |").split(" | ")
        if cells[0] == name:
            return [cell.strip() for cell in cells]
    raise KeyError(f"docs/results.md has no row {name!r} under {heading!r}")
