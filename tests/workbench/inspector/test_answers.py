import pytest

from workbench.inspector import answers as r
from workbench.inspector.actions import InspectorAction
from workbench.inspector.rules import reduce
from workbench.inspector.rules.registry import has_rule

KINDS = [
    value
    for name, value in vars(r).items()
    if isinstance(value, type) and issubclass(value, InspectorAction) and value is not InspectorAction
]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_every_answer_has_a_rule(kind):
    assert has_rule(kind) and callable(reduce)


def test_answers_to_old_wishes_change_nothing(shown, opened, scores, attempt):
    late = (
        r.Opened(99, opened),
        r.OpenFailed(99, "no"),
        r.PlaceScored(99, 1.0, 1.0, scores(1.0, 1.0)),
        r.Replayed(99, shown.choice, attempt()),
        r.Tried(99, shown.choice, (attempt(),)),
        r.TrialFailed(99, shown.choice, "no"),
        r.Judged(99, shown.choice, "good", 1),
    )
    for answer in late:
        assert reduce(shown, answer) == (shown, ()), type(answer).__name__
