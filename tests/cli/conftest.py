"""A scene file and a finished run."""

import pytest
from small_runs import SCENE, melt


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "drop.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """A finished run with its checkpoint."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "drop.toml").write_text(SCENE)
    assert melt("run", folder / "drop.toml", "-o", folder / "run.vtkhdf", "-b", "cpu", "-q").exit_code == 0
    return folder / "run.vtkhdf"
