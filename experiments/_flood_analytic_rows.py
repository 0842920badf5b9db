"""Rows of `experiments.flood_analytic`, from its file."""

import numpy as np

from experiments import Row
from experiments._flood_norms import observed_order

DAM_L1, DAM_VELOCITY, SHOCK, ORDER = 0.015, 0.05, 1.5, 0.7
BOWL_L1, PERIOD, AMPLITUDE = 0.02, 0.002, 0.005
SPEED, SURFACE, EXACT = 1e-4, 0.005, 1e-12
STEADY, MACDONALD, JUMP, REFLECTED, RING = 0.02, 0.03, 2.0, 0.05, 0.02


def all_rows(file):
    """Return the rows of an open file; those of a quick run claim nothing."""
    rows = []
    for make in (_dams, _tables, _bowls, _lakes, _steady, _circle):
        rows += make(file)
    return [row._replace(bound="", ok=None) for row in rows] if file.attrs["quick"] else rows


def _judge(name, expected, value, bound, text, note=""):
    """Return a row that holds if |value| <= bound."""
    return Row(name, expected, text.format(value), f"<= {text.format(bound)}", bool(abs(value) <= bound), note)


def _failed(name, group):
    return [Row(name, "", group.attrs["failed"], "runs", False)] if "failed" in group.attrs else []


def _dams(file):
    rows = []
    for name in file["dam"]:
        sizes = sorted(file[f"dam/{name}"], key=float, reverse=True)
        for size in sizes:
            group = file[f"dam/{name}/{size}"]
            title = f"{name}, r0 = {size} m"
            if failed := _failed(title, group):
                rows += failed
                continue
            a, judged = group.attrs, size == "0.1"
            bars = [file[f"volumes/{name}/{order} {size}"].attrs for order in (1, 2)]
            note = (f"{a['columns']:,} columns, {a['sub_steps']} sub-steps, {a['settings']}; finite volumes of order 1, 2: "
                    f"{bars[0]['L1']:.2%}, {bars[1]['L1']:.2%}; velocity {bars[0]['L1_velocity']:.2%}, {bars[1]['L1_velocity']:.2%}")
            what = [("L1 of depth, columns", "L1", DAM_L1), ("L1 of depth, grid", "grid_L1", DAM_L1),
                    ("velocity, columns", "L1_velocity", DAM_VELOCITY), ("velocity, grid", "grid_L1_velocity", DAM_VELOCITY)]
            for label, key, bound in what:
                rows.append(_judge(f"{title}: {label}", "0", a[key], bound, "{:.2%}", note) if judged else
                            Row(f"{title}: {label}", "0", f"{a[key]:.2%}", "", None, note))
            if "shock" in a:
                rows.append(_judge(f"{title}: shock off by", "0", a["shock"], SHOCK, "{:.2f} r0"))
            else:
                rows.append(Row(f"{title}: foremost column", "9.40 m", f"{a['front']:.2f} m", "", None,
                                "the tip of the exact solution has no depth; the specification's prototype: 7.6 m"))
            rows.append(_judge(f"{title}: volume lost", "0", a["volume_error"], 1e-12, "{:.1e}"))
        found = [file[f"dam/{name}/{size}"].attrs for size in sizes]
        if len(sizes) > 1 and not any("failed" in a for a in found):
            bars = [[file[f"volumes/{name}/{order} {size}"].attrs["L1"] for size in sizes] for order in (1, 2)]
            bar = ", ".join(f"{observed_order(errors, [float(s) for s in sizes]):.2f}" for errors in bars)
            for label, key in (("columns", "L1"), ("grid", "grid_L1")):
                order = observed_order([a[key] for a in found], [float(s) for s in sizes])
                rows.append(Row(f"{name}: observed order of L1, {label}", ">= 0.7", f"{order:.2f}", f">= {ORDER}", order >= ORDER,
                                f"r0 = {', '.join(sizes)} m; finite volumes of order 1, 2: {bar}"))
    return rows


def _tables(file):
    rows = []
    for table in file["table"]:
        for value in file[f"table/{table}"]:
            a = file[f"table/{table}/{value}"].attrs
            if "failed" in a:
                rows.append(Row(f"table of {table}: {value}", "", a["failed"], "", None))
                continue
            shock = f", shock off by {a['shock']:.1f} r0" if "shock" in a else f", foremost column {a['front']:.1f} m"
            rows.append(Row(
                f"table of {table}: {value}", "", f"L1 {a['L1']:.2%}, grid {a['grid_L1']:.2%}, velocity {a['L1_velocity']:.2%}", "", None,
                f"largest |v_y| {a['across']:.2f} m/s{shock}; {a['clamped']} columns at a limit of support; {a['settings']}",
            ))
    return rows


def _bowls(file):
    rows = []
    for kind in file["bowl"]:
        bar = file[f"bowl volumes/{kind}"].attrs.get("L1", np.nan)
        for alpha in file[f"bowl/{kind}"]:
            title = f"bowl, {kind}, {alpha}"
            group = file[f"bowl/{kind}/{alpha}"]
            if failed := _failed(title, group):
                rows += failed
                continue
            a = group.attrs
            note = (f"{a['columns']:,} columns, {a['sub_steps']} sub-steps, {a['settings']}; energy {a['energy']:+.2%}; finite volumes of "
                    f"order 2: {bar:.2%}")
            found = [
                _judge(f"{title}: L1 after 3 periods, columns", "0", a["L1"], BOWL_L1, "{:.2%}", note),
                _judge(f"{title}: L1 after 3 periods, grid", "0", a["grid_L1"], BOWL_L1, "{:.2%}", note),
                _judge(f"{title}: period off by", "0", a["period"], PERIOD, "{:.3%}"),
                _judge(f"{title}: amplitude of the third period off by", "0", a["last_amplitude"], AMPLITUDE, "{:.2%}",
                       "of the centre's motion" if kind != "radial" else "of the mean r^2"),
            ]
            rows += found if alpha == "alpha 1" else [row._replace(bound="", ok=None) for row in found]
    return rows


def _lakes(file):
    rows = []
    for bed in file["lake"]:
        title = f"lake at rest, {bed}"
        if failed := _failed(title, file[f"lake/{bed}"]):
            rows += failed
            continue
        a = file[f"lake/{bed}"].attrs
        note = (f"{a['columns']:,} columns, {a['settings']}; rms {a['speed_rms']:.1e} m/s; largest force left by the start: "
                f"{a['settled']:.1e} m/s in a second times sqrt(d_ref/m)")
        rows += [
            _judge(f"{title}: fastest column", "0", a["speed"], SPEED, "{:.1e} m/s", note),
            _judge(f"{title}: surface off its mean, rms over depth", "0", a["surface_rms"], SURFACE, "{:.2%}",
                   f"mean {a['stage']:+.4f} m off the stage of the fill"),
            _judge(f"{title}: surface off its mean, largest over depth", "0", a["surface"], SURFACE, "{:.2%}"),
        ]
    for bed in file["exact lake"]:
        title = f"lake at rest, {bed}, balanced form"
        if failed := _failed(title, file[f"exact lake/{bed}"]):
            rows += failed
            continue
        a = file[f"exact lake/{bed}"].attrs
        note = (f"{a['columns']:,} columns on a lattice, supports held at one length so that sums are linear in the volumes, volumes "
                f"by a direct solve ({a['least_volume']:.2f} to {a['most_volume']:.2f} of the mean)")
        rows += [_judge(f"{title}: fastest column", "0", a["speed"], EXACT, "{:.1e} m/s", note),
                 _judge(f"{title}: depth of the start off", "0", a["surface"], EXACT, "{:.1e} m", note)]
    return rows


def _steady(file):
    rows = []
    for case in file["steady"]:
        title = f"steady flow, {case}"
        if failed := _failed(title, file[f"steady/{case}"]):
            rows += failed
            continue
        a, bar = file[f"steady/{case}"].attrs, file[f"steady volumes/{case}"].attrs
        bound = MACDONALD if case == "macdonald" else STEADY
        volumes = bar["failed"] if "failed" in bar else f"{bar['L1']:.2%}, q {bar['q']:.2%}"
        note = (f"{a['columns']:,} columns, r0 {a['spacing']:g} m, {a['sub_steps']:,} sub-steps, {a['settings']}; finite volumes of "
                f"order 2: {volumes}")
        rows += [
            _judge(f"{title}: L1 of depth, columns", "0", a["L1"], bound, "{:.2%}", note),
            _judge(f"{title}: L1 of the mean depth, grid", "0", a["mean_L1"], bound, "{:.2%}", f"mean |d/d_exact - 1| {a['relative']:.2%}"),
            _judge(f"{title}: discharge off by", "0", a["q"], bound, "{:.2%}", "mean over the channel and the last quarter of the run"),
            _judge(f"{title}: discharge of the worst section off by", "0", a["q_worst"], bound, "{:.2%}", "mean over that time"),
        ]
        if "jump" in a:
            rows.append(_judge(f"{title}: jump off by", "0", a["jump"], JUMP, "{:.2f} r0"))
    title = "wave that leaves over an edge"
    if failed := _failed(title, file["leaving"]):
        return rows + failed
    a = file["leaving"].attrs
    return [*rows, _judge(f"{title}: what comes back", "0", a["reflected"], REFLECTED, "{:.1%}",
                          f"of a height of {a['incident']:.3f} m; scatter of the surface {a['noise']:.1%}; {a['columns']:,} columns, "
                          f"{a['settings']}")]


def _circle(file):
    rows = []
    for kernel in file["circle"]:
        title = f"circular dam, {kernel}"
        if failed := _failed(title, file[f"circle/{kernel}"]):
            rows += failed
            continue
        a = file[f"circle/{kernel}"].attrs
        note = (f"{a['columns']:,} columns, {a['sub_steps']} sub-steps; L1 {a['L1']:.2%}, "
                f"grid {a['grid_L1']:.2%}, velocity {a['L1_velocity']:.2%} from the run along the radius")
        rows += [
            _judge(f"{title}: std/mean of the depth on rings, mean of rings", "0", a["ring"], RING, "{:.2%}", note),
            _judge(f"{title}: std/mean of the depth on rings, worst ring", "0", a["worst_ring"], RING, "{:.2%}",
                   "rings two spacings wide; the bore stands within the worst one"),
        ]
    return rows
