"""Rows of `experiments.slime_comparison`."""

from experiments import Row


def method(name, f, step):
    """Return the row of a method: its drip, and what was found of its steps."""
    text = (
        f"{f['wall']:.0f} s wall per s, {f['steps'] / f['reached']:.0f} steps per s, {f['iterations'] / f['steps']:.0f} iterations each; "
        f"compression {f['mean']:.1e} mean, {f['most']:.1e} largest; area {100 * (f['area'] - 1):+.1f} %; "
        f"{f['folds']} folds" + (f", {f['rate']:.2f} Hz" if f["rate"] == f["rate"] else "")
    )
    note = f"{f['particles']} particles, dt {1e3 * f['dt']:.3g} ms"
    if step:
        text += f"; largest stable step {1e3 * step['largest']:g} ms"
        note += f"; {step['why']}" if step["why"] else "; the longest tried"
    if f["retries"]:
        note += f"; {f['retries']:.0f} steps halved"
    if f["failed"]:
        note += f"; stopped at {f['reached']:.3g} s: {f['failed']}"
    return Row(name, "", text, "", None, note)


def bounds(drips, full, w, end, dt, fastest):
    """Return the rows that claim something; ``w``: what was found of WCSPH's step."""
    ratio = dt / w["largest"]
    cost = w["ms"] / 1e3 / w["largest"]
    rows = [
        Row("full method: folds", "folds", f"{full['folds']} in {end:g} s", ">= 2", bool(full["folds"] >= 2)),
        Row("full method: area per particle", "1", f"{full['area']:.4f}", "2 %", bool(abs(full["area"] - 1) < 0.02),
            f"{full['area_first']:.4f} of the first 30 layers"),
        Row("WCSPH: largest stable step [s]", f"{w['viscous']:.2g} = 0.125 rho h^2/mu",
            f"{w['largest']:.2g} ({w['unstable']:.2g} diverges)", "", None,
            f"{w['viscous'] / w['largest']:.1f} times less than the formula with h the support, as it is for h its half (a quarter); sound "
            f"would allow {w['sound']:.2g}; {w['ms']:.1f} ms per step in NumPy, {cost:.0f} s wall per s"),
        Row("full method's step over WCSPH's", "", f"{ratio:.0f}", ">= 100", bool(ratio >= 100)),
        Row("WCSPH at the full method's step", "diverges", f"speed {w['speed']:.3g} m/s after {w['at_dt']:.0f} steps", "> 100 x nozzle",
            bool(not w["speed"] < fastest)),
    ]
    for share in (10, 100):
        f = drips[f"WCSPH, mu over {share}"]
        cheaper = f["dt"] / w["largest"]
        rows.append(
            Row(f"WCSPH, mu over {share}: folds", "0: a puddle", f"{f['folds']} in {f['reached']:.2g} s", "0",
                bool(f["folds"] == 0 and not f["failed"]),
                f"{cheaper:.1f} times fewer steps (dt {f['dt']:.2g} s), {f['wall']:.0f} s wall per s; spread {1e3 * f['spread']:.0f} mm, "
                f"height {1e3 * f['height']:.0f} mm; compression {f['mean']:.1e} mean, {f['most']:.1e} largest; {f['failed']}")
        )
    return rows


def noise(name, values):
    """Return the row of a tank at rest."""
    noise, few, count = values
    missing = "a solve did not converge: nothing says where pressure is zero"
    text = f"{count:.0f} particles of density ratio < 0.9: std {few:.3f}"
    stopped = noise != noise
    return Row(
        f"tank at rest, {name}: pressure near the surface, std over rho g d0", "0", "stopped" if stopped else f"{noise:.3f}", "", None,
        missing if stopped else text,
    )
