"""Every command of README.md and of the guides works as it stands, but for its length: runs end after two outer steps."""

import pathlib
import re
import shlex

import pytest
from small_runs import melt

import melt as package
from melt.reproduce import names
from melt.scene import load_scene

ROOT = pathlib.Path(package.__file__).parents[1]
PAGES = [ROOT / "README.md", *(ROOT / "docs" / f"{name}.md" for name in ("melting", "boiling", "flood", "slime"))]
pytestmark = pytest.mark.skipif(not PAGES[0].exists(), reason="no README.md beside the package: melt is installed")
#: What the words in capitals stand for.
MEANT = {"SCENE": "tank_small", "RUN": "a.vtkhdf", "RUN.vtkhdf.capsule.h5": "b.vtkhdf.capsule.h5"}
#: What makes a command short.
SHORTER = {"check": "density", "bench": "1000 --steps 1", "check --capsule": "-b cpu"}
#: Commands that run a scene many times: they have tests of their own.
STUDIES = ("tradeoff", "atlas")
#: Commands whose RUN must be one that they can work on: how it is made.
FIRST = {
    "resume": "run tank_small -o a.vtkhdf -f -q -b cpu --until 0.01s --set time.checkpoint_every=0.005",
    "gauges": "run solitary_beach -o a.vtkhdf -f -q -b cpu --until 0.05s",
    "check --capsule": "run tank_small -o b.vtkhdf -f -q -b cpu --set watch.speed=0.01",  # stopped by its alarm
}


def commands(page):
    """Return the commands of a page, those of blocks first: the files that they leave are what others read."""
    text = page.read_text()
    blocks = re.findall(r"^```sh\n(.*?)^```", text, re.S | re.M)
    lines = [line for block in blocks for line in block.splitlines() if line.startswith("melt ")]
    inline = re.findall(r"`(melt [a-z][^`]*)`", re.sub(r"^```.*?^```", "", text, flags=re.S | re.M))
    found = [shlex.split(line, comments=True)[1:] for line in [*lines, *inline]]
    return [list(words) for words in dict.fromkeys(map(tuple, found))]


def shorter(words):
    """Return the words of a command that takes seconds."""
    kind, words = kind_of(words), [MEANT.get(word, word) for word in words]
    if words[0] == "run" and len(words) > 1:
        preset = words[words.index("--preset") + 1] if "--preset" in words else None
        return [*words, "--until", f"{2 * load_scene(words[1], preset=preset).time.dt!r} s", "--overwrite", "-q"]
    return words + SHORTER.get(kind, "").split()


def kind_of(words):
    """Return the name of a command, with its first option where that makes it another one."""
    return " ".join(words[:2]) if " ".join(words[:2]) in FIRST else words[0]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_commands_of_a_page_work(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    toml = re.findall(r"^```toml\n(.*?)^```", page.read_text(), re.S | re.M)
    for name in ("my_scene.toml", "my_flood.toml"):  # the scene that the page shows
        pathlib.Path(name).write_text(toml[-1] if toml else "")
    for words in commands(page):
        if len(words) == 1 and words[0] in ("run", "plan", "render", "info", "resume", "gauges", "show"):
            continue  # names the command, is none
        if words[0] in STUDIES:
            continue
        if words[0] == "reproduce":  # takes minutes and more
            assert set(words[1:]) <= set(names())
            continue
        if any(word in MEANT and word != "SCENE" for word in words) and kind_of(words) in FIRST:
            melt(*FIRST[kind_of(words)].split())
        found = shorter(words)
        if "--frame" in found:
            found[found.index("--frame") + 1] = "-1"
        result = melt(*found)
        assert result.exit_code == 0, f"melt {' '.join(found)}: {result.output}"


def test_pages_show_runs_of_every_system():
    shown = {words[1] for page in PAGES for words in commands(page) if words[0] == "run" and len(words) > 1}
    scenes = map(load_scene, shown - {"SCENE", "my_scene.toml"})
    kinds = {(s.kind, s.boiling is not None, getattr(s, "incompressible", False)) for s in scenes}
    assert len(kinds) == 4
