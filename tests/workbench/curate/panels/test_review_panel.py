from dataclasses import replace

import pytest

from grasp_core.dataset.agreement import Accuracy, Agreement
from grasp_core.dataset.review import CHOICES, Review, Rule
from grasp_core.errors import GraspError
from workbench.bridge import read_message
from workbench.curate import actions as a
from workbench.curate.panels.review_panel import LABELS, READERS, ReviewPanel


@pytest.fixture
def panel(curation_bridge):
    return ReviewPanel(curation_bridge)


def test_reviews_are_started_by_rule(panel, client, state):
    assert set(LABELS) == set(CHOICES)
    panel.update(None, state)
    assert all(f'data-choice="{choice}"' in client.page() for choice in CHOICES)
    action = read_message("creview:audit,20,1,77:1", READERS)
    assert action == a.StartReview(Rule(choice="audit", size=20, blind=True, seed=77))
    for message in ("creview:audit,21,1,77", "creview:all,20,1,7", "creview:audit"):
        with pytest.raises(GraspError):
            read_message(f"{message}:1", READERS)


def test_progress_open_reviews_and_people(panel, client, state, facts):
    known = replace(
        facts,
        reviews=(Review(3, "ann", Rule(blind=True), 20, 5), Review(2, "ann", Rule(), 9, 9)),
        accuracies=(Accuracy("bob", 10, 8, 1, 0.5, 0.95),),
        agreements=(Agreement(("ann", "bob"), 12, 0.9, 0.75), Agreement(("ann", "eve"), 3, 1.0, None)),
        weights="default",
    )
    panel.update(None, replace(state, facts=known))
    page = client.page()
    assert "cresume:3" in page and "cresume:2" not in page
    assert "8/10 right" in page and "50-95 %" in page and "κ 0.75" in page and "κ –" in page and "default" in page
    panel.update(None, replace(state, facts=known, review=known.reviews[0]))
    page = client.page()
    assert "5 of 20 looked at" in page and "8/10" not in page  # blind: nothing about others
    assert READERS["cresume"]("") == a.ResumeReview(None)


def test_scoring_shows_its_progress(panel, client, state):
    panel.update(None, replace(state, scoring=(3, 12)))
    assert "3 of 12 scenes" in client.page() and "Stop" in client.page()


def test_uploads_become_imports(panel, client, posted):
    import asyncio
    from types import SimpleNamespace

    button = client.only("upload")
    button.value = SimpleNamespace(name="labels.jsonl", content=b"{}")
    asyncio.run(button.handlers[0](SimpleNamespace(client_id=1)))
    assert posted == [a.ImportEvents(b"{}")]
