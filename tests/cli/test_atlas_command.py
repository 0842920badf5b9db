"""The command atlas: what it lists and what it refuses."""

from small_runs import SCENE, melt, refused


def test_maps_are_listed():
    result = melt("atlas", "floating_block_small", "--list")
    assert result.exit_code == 0, result.output
    assert [line.split()[0] for line in result.output.splitlines()] == ["dt-stiffness", "dt-viscosity", "dt-density-ratio"]


def test_unknown_names_are_told():
    refused(melt("atlas", "tank_smal"), "did you mean tank_small")
    refused(melt("atlas", "tank_small", "--map", "dt-stifness"), "did you mean dt-stiffness?")
    refused(melt("atlas", "tank_small", "--map", "moon"), "unknown map 'moon'; tank_small has dt-stiffness, dt-viscosity")


def test_files_are_not_lost(tmp_path):
    scene, out = tmp_path / "drop.toml", tmp_path / "a.h5"
    scene.write_text(SCENE)
    refused(melt("atlas", scene, "-o", tmp_path / "a.png"), "a.png: name it a.h5")
    refused(melt("atlas", scene, "-o", tmp_path / "no" / "a.h5"), "the folder does not exist")
    out.write_text("mine")
    refused(melt("atlas", scene, "-o", out), "--overwrite")
    assert out.read_text() == "mine"
    out.rename(tmp_path / "b.png")
    refused(melt("atlas", scene, "-o", tmp_path / "b.h5"), "b.png exists", "--overwrite")
