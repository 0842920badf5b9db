"""The list of packages in setup.cfg is complete, and data travels with it."""

import configparser
import pathlib

import pytest

import melt.scene

ROOT = pathlib.Path(melt.scene.__file__).resolve().parents[2]


@pytest.fixture
def options():
    if not (ROOT / "setup.cfg").is_file():
        pytest.skip("installed without its source tree")
    parser = configparser.ConfigParser()
    parser.read(ROOT / "setup.cfg")
    return parser


def test_every_package_is_listed(options):
    listed = set(options["options"]["packages"].split())
    folders = {f.parent for f in (ROOT / "melt").rglob("*.py") if "__pycache__" not in f.parts}
    found = {".".join(folder.relative_to(ROOT).parts) for folder in folders}
    assert listed == found | {"melt.data", "melt.experiments"}


def test_every_scene_and_mesh_is_package_data(options):
    patterns = options["options.package_data"]["melt.data"].split()
    shipped = {p for pattern in patterns for p in (ROOT / "data").glob(pattern)}
    wanted = {
        p
        for p in (ROOT / "data").rglob("*")
        if p.suffix in (".toml", ".ply", ".csv") or p.name == "README.md"
    }
    assert wanted and wanted <= shipped
