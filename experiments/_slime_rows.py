"""Rows of `experiments.slime_analytic`, from its file."""

from experiments import Row
from experiments._slime_patch import CENTRE

WORST = "largest L2 from 0.1 to 1 H^2/nu", "worst"
#: Group -> [(what, key, bound, form)] of cases that are judged; slime spec 5.
JUDGED = {
    "couette: 20": [(*WORST, 0.05)], "couette: 40": [(*WORST, 0.02)],
    "couette: 40, a quarter of dt": [(*WORST, 0.02)],
    "poiseuille: 20": [(*WORST, 0.05)], "poiseuille: 40": [(*WORST, 0.02)],
    "ellipse: APIC": [("longer axis off", "x", 0.01), ("shorter axis off", "z", 0.01), ("energy off", "energy", 0.015)],
    "ellipse: nodes": [("longer axis off", "x", 0.01), ("shorter axis off", "z", 0.01), ("energy off", "energy", 0.015)],
    "drop: APIC": [("period off", "period", 0.01), ("swing after 1.5 periods off", "amplitude", 0.03)],
    "tank: APIC": [("L2 of the pressure, mean of instants", "L2_each", 0.01), ("top row, std over rho g d0", "surface_std", 0.3),
                   ("fastest particle over sqrt(g H) after 1 s", "speed", 1e-3)],
    "tank: nodes": [("L2 of the pressure, mean of instants", "L2_each", 0.01), ("top row, std over rho g d0", "surface_std", 0.3),
                    ("fastest particle over sqrt(g H) after 1 s", "speed", 1e-3)],
    "tank: APIC, h = 2 d0": [("L2 of the pressure, mean of instants", "L2_each", 0.025)],
}
#: The same, of ratios that should be 1.
RATIOS = {
    "vortices: nodes": ("decay rate over the exact one", "rate", 0.03),
    "vortices: nodes, disordered": ("decay rate over the exact one", "rate", 0.03),
    "film: 40, hybrid": ("surface speed over the exact one", "ratio", 0.04),
    "film: 20, hybrid": ("surface speed over the exact one", "ratio", 0.04),
}
#: What is told of every case of a kind.
TOLD = {
    "couette": ("L2", "worst", "ratio"), "poiseuille": ("L2", "worst", "ratio"),
    "vortices": ("rate", "rate_of_flow", "step_error", "transfers"),
    "operator": ("own", "wave", "shear", "extension", "mean"), "film": ("ratio", "L2", "depth"),
    "tank": ("L2", "L2_each", "L2_last", "surface_std", "speed", "rms", "largest", "level"),
    "square": ("centre", "spin", "corner", "least", "energy", "density", "loneliest"),
    "ellipse": ("x", "z", "energy", "density"), "drop": ("period", "amplitude", "density"),
}


def all_rows(file):
    """Return the rows of an open file; those of a quick run claim nothing."""
    rows = []
    for name in file:
        rows += _rows(name, file[name].attrs)
    return [row._replace(bound="", ok=None) for row in rows] if file.attrs["quick"] else rows


def _rows(name, a):
    title = name.replace(": ", ", ", 1)
    if "failed" in a:
        return [Row(title, "", a["failed"], "runs" if name in JUDGED or name in RATIOS else "", False if name in JUDGED else None)]
    kind = name.partition(":")[0]
    told = ", ".join(f"{key} {a[key]:.4g}" for key in TOLD[kind] if key in a)
    note = f"{told}; {a['settings']}"
    rows = [Row(f"{title}: {what}", "0", f"{a[key]:.2%}", f"<= {bound:.1%}", bool(abs(a[key]) <= bound), note)
            for what, key, bound in JUDGED.get(name, [])]
    if name in RATIOS:
        what, key, bound = RATIOS[name]
        rows.append(Row(f"{title}: {what}", "1", f"{a[key]:.3f}", f"within {bound:.0%}", bool(abs(a[key] - 1) <= bound), note))
    if "transfers" in a:
        rate = a["rate"] - a["transfers"]
        fits = bool(abs(rate - 1) <= 0.03)
        rows.append(Row(f"{title}: decay rate less that of the transfers", "1", f"{rate:.3f}", "within 3%", fits, note))
    if kind == "square":
        rows += _square(title, name, a, note)
    return rows or [Row(title, "", told, "", None, a["settings"])]


def _square(title, name, a, note):
    claims = name != "square: DFSPH"
    rows = [
        Row(f"{title}: pressure in the middle over rho w^2 L^2", f"{-CENTRE}", f"{a['centre']:.4f}", "within 1%",
            bool(abs(a["centre"] / -CENTRE - 1) <= 0.01), note),
        Row(f"{title}: angular momentum off at w t = 2", "0", f"{a['spin']:+.2%}", "<= 1%", bool(abs(a["spin"]) <= 0.01)),
        Row(f"{title}: corner over its largest reach", "<= 1", f"{a['corner']:.3f}", "<= 1", bool(a["corner"] <= 1.0)),
    ]
    if claims:
        whole = bool(a["loneliest"] <= 1.5)
        name = f"{title}: farthest from its next neighbour at w t = 2"
        return [*rows, Row(name, "no fragmentation", f"{a['loneliest']:.2f} d0", "<= 1.5 d0", whole)]
    held = bool(a["least"] >= 0 and a["loneliest"] > 2)
    return [row._replace(bound="", ok=None) for row in rows] + [
        Row(f"{title}: falls apart, without negative pressure", "gaps > 2 d0, p >= 0", f"{a['loneliest']:.1f} d0, {a['least']:.2g}",
            "seen to", held, "the method has only positive pressure: that is why there is a Poisson equation")]
