"""What README.md and the guides say is so: Python runs, links lead somewhere, scenes are valid, commands are known."""

import pathlib
import re

import pytest

import melt

ROOT = pathlib.Path(melt.__file__).parents[1]
README = ROOT / "README.md"
TEXT = README.read_text() if README.exists() else ""
pytestmark = pytest.mark.skipif(not TEXT, reason="no README.md beside the package: melt is installed")


GUIDES = [ROOT / "docs" / f"{name}.md" for name in ("melting", "boiling", "flood", "slime")]


def blocks(language, text=TEXT):
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.S | re.M)


@pytest.mark.parametrize("number", range(len(blocks("python"))))
def test_python_block_runs(number, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(blocks("python")[number], f"README.md, python block {number}", "exec"), {})


def test_there_is_python_to_run():
    assert blocks("python")


@pytest.mark.parametrize("page", [README, *GUIDES, ROOT / "CONTRIBUTING.md"], ids=lambda page: page.stem)
def test_relative_links_exist(page):
    links = re.findall(r"\]\(([^)#\s]+)", page.read_text())
    relative = [link for link in links if "://" not in link]
    assert relative or page != README
    missing = [link for link in relative if not (page.parent / link).exists()]
    assert not missing, missing


def test_files_named_in_code_exist():
    named = set(re.findall(r"`((?:melt|docs)/[\w/]+\.\w+)`", TEXT))
    assert named
    assert not [name for name in named if not (ROOT / name).exists()]


@pytest.mark.parametrize("guide", GUIDES, ids=lambda guide: guide.stem)
def test_scene_of_a_guide_is_valid(guide):
    from melt.scene import scene_from_toml

    scenes = blocks("toml", guide.read_text())
    assert scenes
    for text in scenes:
        scene_from_toml('[scene]\nname = "guide"\n' + text)


def test_commands_are_known():
    import typer

    from melt.cli import app

    known = set(typer.main.get_command(app).commands)
    named = set(re.findall(r"`melt ([a-z]+)", TEXT))
    assert named and named <= known, named - known


def test_figures_are_those_of_the_results_page():
    from experiments import _headlines

    filled = _headlines.fill(TEXT, (ROOT / "docs" / "results.md").read_text())
    assert filled == TEXT, "run python -m experiments --report-only"
    assert filled.count("| yes |") + filled.count("**MISS**") >= 6
