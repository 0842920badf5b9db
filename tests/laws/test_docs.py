"""Generated pages are current."""

from melt.docs import PAGE, stages_page
from melt.stages import STAGES


def test_stages_page_is_what_the_registry_says():
    assert PAGE.read_text() == stages_page(), "run python -m melt.docs"


def test_stages_page_names_every_stage():
    text = stages_page()
    assert all(f"### {stage}\n" in text for stage in STAGES)
