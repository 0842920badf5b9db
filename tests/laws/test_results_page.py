"""The results page: links of its contents lead to its sections, and its misses are those of the tables."""

import pathlib
import re

import pytest

import melt
from experiments import Row, _results

PAGE = pathlib.Path(melt.__file__).parents[1] / "docs" / "results.md"
pytestmark = pytest.mark.skipif(not PAGE.exists(), reason="no docs beside the package: melt is installed")


class Module:
    """Some of a kind. V1, a_b

    What is claimed.
    """


ROWS = [
    Row("lake at rest, island: speed", "0", "1", "< 1", False),
    Row("lake at rest, shore: speed", "0", "2", "< 1", False),
    Row("drop, grid", "0", "0", "< 1", True),
    Row("figure", "", "3", "", None),
]


def contents(page):
    """Return [(heading, anchor, what is said of it)]."""
    return re.findall(r"^- \[(.*)\]\(#(.*)\)(?:\\\*)?: (.*)$", page.partition("\n## ")[0], re.M)


def test_contents_name_each_section_with_its_misses_in_short():
    page = _results.markdown([(Module, ROWS)], "melt", kept={"Older: one, two (V2)": "## Older: one, two (V2)\n\nnothing\n"})
    assert contents(page) == [
        ("Older: one, two (V2)", "older-one-two-v2", "no bounds"),
        ("Some of a kind. V1, a_b", "some-of-a-kind-v1-a_b", "**2 of 3 missed**: lake at rest (2)"),
    ]
    assert "\n1 of 3 bounds hold.\n" in page and "#older-one-two-v2)\\*: no" in page and "\n\\* kept from an earlier page" in page


def test_the_page_links_to_all_its_sections_in_order():
    page = PAGE.read_text()
    headings = [part.partition("\n")[0] for part in page.split("\n## ")[1:]]
    assert [heading for heading, _, _ in contents(page)] == headings
    anchors = [anchor for _, anchor, _ in contents(page)]
    assert len(set(anchors)) == len(anchors) and all(re.fullmatch(r"[\w-]+", anchor) for anchor in anchors)


def test_the_misses_of_the_contents_are_those_of_the_tables():
    page = PAGE.read_text()
    for heading, _, said in contents(page):
        section = page.split(f"\n## {heading}\n")[1].split("\n## ")[0]
        misses = section.count("| **MISS** |")
        assert (re.match(r"\*\*(\d+) of", said) or [0, "0"])[1] == str(misses), heading
    held, total = map(int, re.search(r"^(\d+) of (\d+) bounds hold\.$", page, re.M).groups())
    verdicts = re.findall(r"^\|(?:[^|]*\|){4} (yes|\*\*MISS\*\*) \|", page, re.M)  # fifth column
    assert (held, total) == (verdicts.count("yes"), len(verdicts))
    assert max(map(len, page.partition("\n## ")[0].splitlines())) < 1500
