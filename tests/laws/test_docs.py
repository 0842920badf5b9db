"""Generated pages are current."""

import pytest

from melt import costs
from melt.docs import PAGE, SCENES, stages_page
from melt.scene import load_scene
from melt.scene.load import shipped_scenes
from melt.stages import STAGES

ROWS = costs.rows_of(SCENES.read_text())
QUICK = 7000  # particles up to which a scene is built in about a second


def test_stages_page_is_what_the_registry_says():
    assert PAGE.read_text() == stages_page(), "run python -m melt.docs"


def test_stages_page_names_every_stage():
    text = stages_page()
    assert all(f"### {stage}\n" in text for stage in STAGES)


def test_scenes_page_has_every_shipped_scene():
    assert set(ROWS) == set(shipped_scenes())


def test_scenes_page_keeps_rows_of_data_that_are_elsewhere(monkeypatch):
    monkeypatch.setattr(costs, "has_data", lambda scene: False)
    assert costs.page(SCENES.read_text()) == SCENES.read_text()


@pytest.mark.parametrize("name", [n for n, line in ROWS.items() if int(line.split(" | ")[2].replace(",", "")) <= QUICK])
def test_a_scene_pays_for_what_the_page_says(name):
    if not costs.has_data(load_scene(name)):
        pytest.skip("its measured terrain is not here (MELT_DATA)")
    assert costs.row(name) == ROWS[name], "launches or holds other than before; if meant: run python -m melt.docs"


def test_a_scene_with_more_in_it_costs_more():
    bare, full = (costs.cost_of(load_scene("tank_small", o)) for o in ([], costs.everything_of("tank_small")))
    assert full.stages > 2 * bare.stages and full.fields > 2 * bare.fields and full.nbytes > bare.nbytes
    assert "solids" in full.required and "solids" not in bare.required
