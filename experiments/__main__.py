"""Run every experiment and write docs/results.md and the figures of README.md: ``python -m experiments [--quick] [NAME ...]``."""

import argparse
import pathlib
import time

from experiments import _headlines, load, names
from experiments._results import markdown, provenance_line, sections_of, title


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="experiments to run (all)")
    parser.add_argument("--quick", action="store_true", help="small versions, not for publication")
    parser.add_argument("--out", default="results", help="folder of the HDF5 files")
    parser.add_argument("--report-only", action="store_true", help="use the HDF5 files that are there")
    given = parser.parse_args()
    folder = pathlib.Path(given.out)
    folder.mkdir(parents=True, exist_ok=True)
    for name in given.names or names():
        if given.report_only:
            continue
        began = time.perf_counter()
        print(f"== {name}", flush=True)
        load(name).run(folder / f"{name}.h5", quick=given.quick)
        print(f"== {name}: {time.perf_counter() - began:.0f} s", flush=True)
    there = [n for n in names() if (folder / f"{n}.h5").exists()]
    sections = [(load(n), load(n).report(folder / f"{n}.h5")) for n in there]
    target = folder / "results.md" if given.quick else pathlib.Path("docs/results.md")
    kept = sections_of(target.read_text()) if target.exists() else {}
    known = {title(load(n)) for n in names()}
    kept = {heading: text for heading, text in kept.items() if heading in known}
    not_run = [n for n in names() if n not in there and title(load(n)) not in kept]
    text = markdown(sections, provenance_line(), not_run, kept)
    target.write_text(text)
    if not given.quick:
        page = pathlib.Path("README.md")
        page.write_text(_headlines.fill(page.read_text(), text))
    print(f"wrote {target}")


if __name__ == "__main__":
    main()
