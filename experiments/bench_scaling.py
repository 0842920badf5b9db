"""Cost per stage, per pair and per particle: linear in n, 1 against 2 threads, memory, fluid-only page.

A block of water in a tank, single precision, h/dx = 2.5, one sub-step per step with the sound speed that allows it.
"page over bare" is the whole step page of a fluid-only scene over the same stages called by hand: what heat and solids
cost where there are none.
"""

import h5py
import numpy as np

from experiments import Row
from melt import bench


def run(out, quick=False, say=print):
    """Run the scaling series (``quick``: 3 000 particles)."""
    bench.run((3_000,) if quick else bench.SIZES, out=out, say=say)
    with h5py.File(out, "r+") as file:
        file.attrs["quick"] = quick


def report(path):
    """Return rows per size and thread count, the linearity, and the slowest stages at 60k."""
    rows = []
    with h5py.File(path) as file:
        claimed = not file.attrs["quick"]
        runs = [(dict(file[k].attrs), dict(file[k]["ms"].attrs)) for k in sorted(file)]
    for a, _ in runs:
        rows.append(Row(
            f"{a['liquid']:,} liquid + {a['particles'] - a['liquid']:,} wall, {a['threads']} thread(s)", "",
            f"{a['step_ms']:.2f} ms per step, {1e6 * a['step_ms'] / a['pairs']:.2f} ns per pair", "", None,
            f"{a['neighbours']:.0f} neighbours, {a['bytes'] / a['particles']:.0f} bytes per particle, {a['precision']}",
        ))
    most = max(a["threads"] for a, _ in runs)
    per_pair = [1e6 * a["step_ms"] / a["pairs"] for a, _ in runs if a["threads"] == most and a["liquid"] > 30_000]
    if len(per_pair) > 1:
        spread = max(per_pair) / min(per_pair)
        rows.append(Row("cost per pair, 60k to 1M: largest over smallest", "1 (linear in n)", f"{spread:.2f}", "<= 1.5",
                        bool(spread <= 1.5)))
    page = [a["page_over_bare"] for a, _ in runs if np.isfinite(a["page_over_bare"])]
    rows.append(Row("fluid-only: page over bare stages", "1", ", ".join(f"{p:.2f}" for p in page),
                    "<= 1.1 (median)" if claimed else "", bool(np.median(page) <= 1.1) if claimed else None))
    middle = next((r for r in runs if r[0]["threads"] == most and 30_000 < r[0]["liquid"] < 100_000), runs[-1])
    for name, ms in sorted(middle[1].items(), key=lambda item: -item[1])[:10]:
        rows.append(Row(f"stage {name} at {middle[0]['liquid']:,}", "", f"{ms:.3f} ms", "", None,
                        f"{ms / sum(middle[1].values()):.0%} of the step, {1e6 * ms / middle[0]['pairs']:.3f} ns per pair, "
                        f"{middle[0]['particles'] / ms / 1e3:.0f} M particles/s"))
    return rows
