from grasp_core.evaluation.crosscheck import Comparison, Crosscheck, Goal, Unstable
from grasp_core.evaluation.crosscheck_text import text
from grasp_core.evaluation.disagreements import Disagreement
from grasp_core.simulation.crosscheck import Agreement

PAIRS = {"MISSED→MISSED": 5, "MISSED→SLIPPED": 1, "SUCCESS→SLIPPED": 4, "SUCCESS→SUCCESS": 90}
FOUND = Disagreement(4, {"mug": 3, "pen": 1}, {"dart": "SUCCESS: held", "half": "MISSED: gone"}, False, 3, "a/b.png")
HALF = Comparison(
    words="half the time step",
    goal=0.97,
    all=Agreement(100, 0.96, 0.73, 0.95, PAIRS),
    objects={"mug": Agreement(60, 0.95, 0.7, 0.95, {}), "pen": Agreement(40, 0.975, 0.8, 0.95, {})},
    pictures={"SUCCESS→SLIPPED": "a/b.png"},
    disagreements={"SUCCESS→SLIPPED": FOUND},
    left_out=0.01,
)
GOALS = {
    "half": Goal(0.96, 0.902, 0.984, 0.97, False),
    "correlation": Goal(None, None, None, 0.95, None),
    "unstable": Goal(0.0, 0.0, 0.0004, 0.001, True),
}
RESULT = Crosscheck({"half": HALF}, None, 0.0, 7, {"dart": Unstable(0, 9000), "half": Unstable(1, 101)}, GOALS)


def cells(line):
    return line.split()


def test_goals_stand_beside_figures_and_intervals():
    lines = text(RESULT).splitlines()
    half = next(line for line in lines if line.startswith("half: half the time step"))
    for words in ("0.960", "0.902 to 0.984", ">= 0.97", "not met", "0.73", "1.00%"):
        assert words in half
    unstable = next(line for line in lines if line.startswith("diverged executions of DART"))
    assert "< 0.1%" in unstable
    assert unstable.rstrip().endswith("met")
    assert any("undefined" in line and line.startswith("the correlation") for line in lines)
    assert "dart 0 of 9000, half 1 of 101" in text(RESULT)


def test_every_object_has_count_agreement_and_kappa():
    lines = text(RESULT).splitlines()
    assert cells(next(line for line in lines if line.startswith("mug"))) == ["mug", "60", "0.950", "0.70"]
    assert cells(next(line for line in lines if line.startswith("pen"))) == ["pen", "40", "0.975", "0.80"]


def test_the_whole_matrix_is_shown():
    lines = text(RESULT).splitlines()
    start = next(number for number, line in enumerate(lines) if line.startswith("outcomes, half in columns"))
    assert cells(lines[start])[-3:] == ["SUCCESS", "MISSED", "SLIPPED"]
    assert cells(lines[start + 2]) == ["DART", "SUCCESS", "90", "0", "4"]
    assert cells(lines[start + 3]) == ["DART", "MISSED", "0", "5", "1"]


def test_disagreements_are_told_in_words():
    told = text(RESULT)
    assert "SUCCESS→SLIPPED: 4 (mug 3, pen 1)" in told
    assert "half's film: MISSED: gone" in told
    assert "none of 3 filmed ends as judged; a/b.png" in told
