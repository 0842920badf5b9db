"""Rows of `experiments.flood_control`, from its file."""

import numpy as np

from experiments import Row

#: Largest speed [m/s], largest E/E0, water left on the plateau [m^2] in the specification's 1-D prototype.
PROTOTYPE = {
    "off": (15.8, 6.4, 8.75),
    "own point": (9.4, 1.7, 8.75),
    "4 points, l = h (paper)": (13.4, 5.1, 15.75),
    "4 points, l <= 2 r0": (9.4, 1.8, 9.75),
}
RITTER = 8 / 27 * np.sqrt(9.81)  # discharge over the edge of water 1 m deep [m^2/s]
FALL = np.sqrt(2 * 9.81 * 11.0)  # speed of a bead from the surface to the foot of the cliff [m/s]
METRICS = (
    ("deepest", "pile-up: greatest depth", "m"),
    ("deep", "pile-up: depth that 0.1 % exceed", "m"),
    ("crowded", "pile-up: share with > 2 x 22 neighbours", ""),
    ("closest", "pile-up: closest pair", "r0"),
    ("alone", "splash: share with < 3 neighbours", ""),
    ("dispersion", "splash: rms of (v - mean of neighbours)/sqrt(g d)", ""),
    ("too_fast", "splash: share faster than a free fall from the highest surface", ""),
    ("fastest", "greatest speed", "m/s"),
    ("energy", "energy: greatest [v^2 (1 + slope^2)/2 + g (b + d/2)]/E0", ""),
    ("reach", "cost: radius that holds 95 % at the end", "m"),
    ("arrival", "cost: 1 % is further than 60 m", "s"),
    ("sub_steps", "sub-steps of the run", ""),
)


def all_rows(file):
    """Return the rows of an open file."""
    return [*_gentle(file), *_single(file), *_cliff(file), *_figures(file)]


def _row(name, expected, measured, bound="", ok=None, note=""):
    return Row(name, expected, measured, bound, None if ok is None else bool(ok), note)


def _gentle(file):
    rows = []
    for name in file["VC2"]:
        a = file["VC2"][name].attrs
        if name == "steep bowl":
            rows.append(
                _row(
                    "Thacker 1-D, slopes to 1.5: error of the centroid over one period, off / on",
                    "0 (exact solution)",
                    f"{a['off']:.2%} / {a['on']:.2%}",
                    "",
                    None,
                    "of the amplitude; the force alters a true solution where it acts",
                )
            )
            continue
        which = "VC1" if a["slope"] < 1e-6 else "VC2"
        rows.append(
            _row(
                f"{which} {name}: positions, speeds and depths on against off",
                "bit-identical",
                "bit-identical" if a["same"] else "differ",
                "bit-identical",
                a["same"],
                f"{a['columns']:,} columns, {a['steps']} steps, steepest {a['slope']:.3f}",
            )
        )
        rows.append(_row(f"{which} {name}: largest brake", "0", f"{a['brake']:g} m/s^2", "0", a["brake"] == 0))
    return rows


def _single(file):
    a = file["VC3"].attrs
    rows = [
        _row("VC3 brake of a column at rest", "0", f"{a['rest']:g}", "0", a["rest"] == 0, "slope 1, before its first move")
    ]
    for slope, truth in (("1", (9.81, 4.905)), ("3", (29.43, 2.943))):
        a = file[f"VC4/{slope}"].attrs
        for name, key, value in (("without control", "free", truth[0]), ("with control", "on", truth[1])):
            rows.append(
                _row(
                    f"VC4 acceleration of one column on a slope of {slope}, {name}",
                    f"{value:g} m/s^2",
                    f"{a[key]:.4f}",
                    "+- 1 %",
                    abs(a[key] / value - 1) <= 0.01,
                    "s_on = 0",
                )
            )
    a = file["VC5"].attrs
    change = [abs(a[f"dt{k + 1}"] / a[f"dt{k}"] - 1) for k in (0, 1)]
    rows.append(
        _row(
            "VC5 brake at one time, time steps of 20, 10, 5 ms",
            "independent of dt",
            " / ".join(f"{c:.2%}" for c in change),
            "< 1 % per halving",
            max(change) < 0.01,
            "one column over a smooth hill, 0.8 s",
        )
    )
    for mode in file["VC6"]:
        gain = file["VC6"][mode].attrs["gain"]
        rows.append(
            _row(
                f"VC6 largest growth of a speed by the force, {mode}",
                "<= 0",
                f"{gain:.2g} m/s",
                "<= 0",
                gain <= 0,
                "rough_terrain, all steps",
            )
        )
    return rows


def _cliff(file):
    rows, free = [], file["cliff/off"].attrs["discharge"]
    for name in [*PROTOTYPE, *(set(file["cliff"]) - set(PROTOTYPE))]:
        speed, energy, plateau = (f"{v:g}" for v in PROTOTYPE[name]) if name in PROTOTYPE else ("-", "-", "-")
        a = file["cliff"][name].attrs
        note = f"{a['columns']} columns; volume error {a['left']:.1e}"
        rows += [
            _row(
                f"cliff, {name}: greatest speed",
                f"{speed} m/s",
                f"{a['speed']:.2f}",
                "",
                None,
                f"bead from the surface: {FALL:.1f}; {note}",
            ),
            _row(f"cliff, {name}: greatest E/E0", energy, f"{a['energy']:.2f}"),
            _row(f"cliff, {name}: water left on the plateau", f"{plateau} of 20 m^2", f"{a['plateau']:.2f}"),
        ]
        ritter = abs(a["discharge"] / RITTER - 1)
        if name == "off":
            rows.append(
                _row(
                    "cliff, off: discharge over the edge",
                    f"{RITTER:.4f} m^2/s (Ritter)",
                    f"{a['discharge']:.4f}",
                    "+- 5 %",
                    ritter <= 0.05,
                )
            )
        else:
            rows.append(
                _vc7(
                    f"VC7 cliff, {name}: discharge against off",
                    a["discharge"] / free - 1,
                    f"arrival of 1/4 m^2 {a['arrival']:.2f} s",
                )
            )
    if "spread" not in file:
        return rows
    for name in file["spread"]:
        a = file["spread"][name].attrs
        rows.append(
            _row(
                f"cliff, corners at {name} h (at least half a cell): discharge against off",
                "0",
                f"{a['discharge'] / free - 1:+.1%}",
                "",
                None,
                f"speed {a['speed']:.2f} m/s, E/E0 {a['energy']:.2f}, plateau {a['plateau']:.2f} m^2",
            )
        )
    for r0 in file["sheer/off"]:
        off = file[f"sheer/off/{r0}"].attrs
        for name in ("own point", "4 points, l <= 2 r0"):
            on = file[f"sheer/{name}/{r0}"].attrs
            note = f"off {off['discharge']:.3f} m^2/s, speed {off['speed']:.1f} m/s; on {on['discharge']:.3f}, {on['speed']:.1f}"
            title = f"VC7 sheer cliff of one cell (0.25 m), r0 = {r0} m, {name}: discharge against off"
            rows.append(_vc7(title, on["discharge"] / off["discharge"] - 1, note))
    return rows


def _vc7(name, change, note):
    return _row(name, "0", f"{change:+.1%}", "+- 2 %", abs(change) <= 0.02, note)


def _figures(file):
    runs = {name: file[f"rough/{name}"].attrs for name in ("off", "on", "near")}
    note = f"{runs['off']['columns']:,} columns, {runs['off']['end']:.3g} s; near: corners at h/4"
    rows = []
    for key, label, unit in METRICS:
        measured = " / ".join(f"{a[key]:.3g}" for a in runs.values())
        rows.append(_row(f"Figure 8, {label}: off / on / near", "", f"{measured} {unit}".strip(), "", None, note))
    for name, a in runs.items():
        kept = abs(a["error"]) <= 1e-12
        rows.append(_row(f"Figure 8, control {name}: error of the volume", "0", f"{a['error']:.1e}", "1e-12", kept))
    for name in file["obstacles"]:
        a = file["obstacles"][name].attrs
        note = f"{a['columns']:,} columns; {a['lost']:.0f} taken out; {a['before']:.2f} m deep before the cuboid at most"
        measured = f"{a['inside']} of {a['looks']:,} places"
        rows.append(_row(f"Figure 9 ({name}): columns inside an obstacle, ever", "0", measured, "0", a["inside"] == 0, note))
    return rows
