"""The report of a cross-check for people: goals, tables by object, confusion matrices and what the pictures show."""

from __future__ import annotations

from collections.abc import Iterable

from grasp_core.evaluation.crosscheck import Comparison, Crosscheck, Goal
from grasp_core.evaluation.report import table
from grasp_core.simulation.evidence import Outcome


def text(result: Crosscheck) -> str:
    """Everything that was found, section by section."""
    sections = [_goals(result), _objects(result)]
    sections += [_confusion(name, comparison) for name, comparison in result.engines.items()]
    sections += [_disagreements(name, comparison) for name, comparison in result.engines.items()]
    return "\n\n".join(sections)


def _goals(result: Crosscheck) -> str:
    rows = []
    for name, goal in result.goals.items():
        if name == "unstable":
            executions = result.unstable["dart"].executions
            rows.append(("diverged executions of DART", executions, *_cells(goal, percent=True), "", "", ""))
        elif name == "correlation":
            words = "qualities with noise, DART and MuJoCo, correlation"
            rows.append((words, result.qualities, *_cells(goal), "", "", ""))
        else:
            found = result.engines[name]
            rest = (f"{found.all.kappa:.2f}", f"{found.all.outcomes:.3f}", f"{found.left_out:.2%}")
            rows.append((f"{name}: {found.words}, agreement", found.all.count, *_cells(goal), *rest))
    header = ("goal", "n", "figure", "95 % interval", "wanted", "", "kappa", "same outcome", "left out")
    lines = [table(header, rows)]
    if result.qualities and result.quality_correlation is None:
        lines.append(
            "the correlation is undefined: all qualities of one engine are equal; take more grasps or attempts"
        )
    if result.quality_difference is not None:
        lines.append(f"qualities differ by {result.quality_difference:.3f} on average")
    counts = ", ".join(f"{name} {each.diverged} of {each.executions}" for name, each in result.unstable.items())
    lines.append(f"diverged executions, no verdicts and left out of agreement: {counts}")
    return "\n".join(lines)


def _cells(goal: Goal, *, percent: bool = False) -> tuple[str, str, str, str]:
    """Figure, interval, what is wanted, and whether that is met."""

    def show(value: float | None) -> str:
        return "undefined" if value is None else f"{value:.3%}" if percent else f"{value:.3f}"

    interval = "" if goal.low is None else f"{show(goal.low)} to {show(goal.high)}"
    wanted = f"< {goal.goal:.1%}" if percent else f">= {goal.goal:g}"
    return show(goal.figure), interval, wanted, {True: "met", False: "not met", None: "open"}[goal.met]


def _objects(result: Crosscheck) -> str:
    names = dict.fromkeys(name for each in result.engines.values() for name in each.objects)
    rows = []
    for name in names:
        cells: list[object] = [name]
        for each in result.engines.values():
            found = each.objects.get(name)
            cells += [found.count, f"{found.agreement:.3f}", f"{found.kappa:.2f}"] if found else ["", "", ""]
        rows.append(cells)
    header = [column for engine in result.engines for column in (f"{engine}: n", "agreement", "kappa")]
    return table(["object", *header], rows)


def _confusion(name: str, comparison: Comparison) -> str:
    counts = comparison.all.confusion
    pairs = [pair.split("→") for pair in counts]
    rows = _ordered(one for one, _ in pairs)
    columns = _ordered(other for _, other in pairs)
    cells = [[f"DART {one}", *(counts.get(f"{one}→{other}", 0) for other in columns)] for one in rows]
    return table([f"outcomes, {name} in columns", *columns], cells)


def _ordered(outcomes: Iterable[str]) -> list[str]:
    """Those that occur, in the order of `Outcome`."""
    found = set(outcomes)
    return [str(outcome) for outcome in Outcome if outcome in found]


def _disagreements(name: str, comparison: Comparison) -> str:
    if not comparison.disagreements:
        return f"DART and {name}: no outcome differs"
    lines = [f"where DART and {name} differ (DART's outcome first):"]
    for words, each in comparison.disagreements.items():
        objects = ", ".join(f"{one} {count}" for one, count in each.objects.items())
        lines.append(f"  {words}: {each.count} ({objects})")
        lines += [f"    {engine}'s film: {said}" for engine, said in each.words.items()]
        ends = "the films end as judged" if each.as_judged else f"none of {each.filmed} filmed ends as judged"
        lines.append(f"    {ends}; {each.picture}")
    return "\n".join(lines)
