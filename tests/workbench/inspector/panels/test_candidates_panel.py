from dataclasses import replace

from workbench.bridge import read_message
from workbench.inspector.actions import Select
from workbench.inspector.panels.candidates_panel import READERS, CandidatesPanel, listing, selection, stages
from workbench.inspector.state import TrialState


def test_the_list_is_in_the_plan_s_order_with_its_numbers(shown, bridge):
    page = listing(shown, bridge)
    assert page.count("data-candidate=") == 3
    assert page.index("0.900") < page.index("0.600") < page.index("0.300")
    assert "cascade in 40 ms" in page and ">80<" in page


def test_trials_and_verdicts_show_in_the_list(shown, bridge, attempt):
    trial = TrialState({0: attempt(0), 1: attempt(1, "SLIPPED")}, complete=True)
    page = listing(replace(shown, trials={1: trial}, verdicts={1: "bad"}), bridge)
    assert ">1/2<" in page and "✗" in page


def test_an_empty_plan_says_why(state, empty_scene, bridge):
    page = listing(replace(state, scene=empty_scene, making=None), bridge)
    assert "No grasp: nothing stands on the table" in page


def test_before_the_first_plan(state, bridge):
    assert "come with the first plan" in listing(state, bridge)
    assert "no plan" in listing(replace(state, making=None, failure="x"), bridge)


def test_times_add_up():
    page = stages({"rectify": 10.0, "refined<": 30.0, "unused": 0.0})
    assert "width:25.0%" in page and "width:75.0%" in page and "unused" not in page
    assert "refined&lt;" in page


def test_the_selection_is_a_style_so_that_nothing_else_is_sent(bridge, client, shown):
    panel = CandidatesPanel(bridge)
    panel.update(None, shown)
    table = next(made for made in client.made if made.kind == "html" and "<table" in made.content)
    table.content = "untouched"
    panel.update(shown, replace(shown, selected=2))
    assert table.content == "untouched"
    assert any(".gw-c2" in made.content for made in client.made if made.kind == "html")
    assert selection(None) == "<style></style>"


def test_a_click_in_list_or_image_selects():
    assert read_message("select:2:1", READERS) == Select(2)
