"""grasp-core: one small module per command, imported only when it is called."""

import contextlib
import importlib
import io
import os
import re
import sys
from collections.abc import Sequence
from typing import Protocol, cast

from grasp_core.errors import Cancelled, GraspError


class Command(Protocol):
    """A command is a dataclass of its arguments with a `run` method."""

    def run(self) -> int | None:
        """Do it; the exit status, 0 when None."""
        ...


COMMANDS: dict[str, tuple[str, str, str]] = {
    "objects list": ("objects", "List", "families of the catalogue and installed sets"),
    "objects sheet": ("objects", "Sheet", "a contact sheet of objects"),
    "objects export": ("objects", "Export", "write objects as URDF or asset files"),
    "plan": ("plan", "PlanCommand", "grasps from one depth image"),
    "generate": ("generate", "Generate", "make a dataset from a recipe"),
    "dataset info": ("dataset", "Info", "what a dataset holds"),
    "dataset verify": ("dataset", "Verify", "check every file, hash and label of a dataset"),
    "dataset stats": ("dataset", "Stats", "outcomes, quality, graspable share and comfort, with a picture"),
    "dataset merge": ("dataset", "Merge", "join datasets that were made on several machines"),
    "dataset archive": ("dataset", "Archive", "write the labels of a dataset as one small file"),
    "dataset restore": ("dataset", "Restore", "rebuild a dataset from such a file, without physics"),
    "dataset export": ("dataset", "Export", "write label events as JSON Lines"),
    "dataset import": ("dataset", "Import", "add label events from JSON Lines"),
    "dataset score": ("curate", "Score", "score every grasp with the networks, for lists"),
    "dataset relabel": ("curate", "Relabel", "one decision on every sample of a filtered list, counted first"),
    "dataset people": ("curate", "People", "who labelled, their agreement (Cohen's kappa) and their accuracy"),
    "train regression": ("train", "Regression", "train the Regression Network on a dataset"),
    "train refined": ("train", "Refined", "train the Refined Network on a dataset"),
    "train all": ("train", "All", "train both networks and pack their weights"),
    "train compare": ("train", "Compare", "train variants for a few epochs and compare them"),
    "train pack": ("train", "Pack", "pack trained networks into one weights file"),
    "train assess": ("train", "Assess", "measure weights on a dataset, with figures"),
    "trial": ("trial", "TrialCommand", "execute one grasp on one object in DART"),
    "crosscheck": ("crosscheck", "CrosscheckCommand", "compare the verdicts of physics engines"),
    "benchmark success": ("benchmark_success", "BenchmarkSuccess", "success of planners on unseen objects, in DART"),
    "benchmark trials": ("benchmark_trials", "BenchmarkTrials", "how fast trials are, beside MuJoCo"),
    "benchmark curation": ("benchmark_curation", "BenchmarkCuration", "pages, filters and labels of a large dataset"),
    "benchmark mending": ("benchmark_mending", "BenchmarkMending", "spoil labels, find and mend them, train again"),
    "benchmark latency": ("benchmark_latency", "BenchmarkLatency", "how long a plan takes, by stage and backend"),
}
"""Words of a command → (module in this package, class, what it does)."""


def _usage() -> str:
    width = max(map(len, COMMANDS), default=0)
    lines = [f"  {words:<{width}}  {text}" for words, (_, _, text) in COMMANDS.items()]
    return "\n".join(
        ["usage: grasp-core COMMAND [options] [--debug]", "", *lines, "", "grasp-core COMMAND --help shows the options"]
    )


def _find(arguments: Sequence[str]) -> tuple[str, list[str]] | None:
    for count in (2, 1):
        words = " ".join(arguments[:count])
        if words in COMMANDS:
            return words, list(arguments[count:])
    return None


def _one_line(box: str) -> str:
    """What tyro frames in a box, as one line."""
    words = re.sub(r"[─-╿]+", " ", re.sub(r"\x1b\[[0-9;]*m", "", box)).split()
    return " ".join(words).removeprefix("Parsing error ").removeprefix("Required options ")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; exit status 0 done, 2 bad input or usage, 1 anything else, 130 cancelled."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in given
    given = [word for word in given if word != "--debug"]
    if not given or given[0] in ("-h", "--help"):
        print(_usage())
        return 0 if given else 2
    found = _find(given)
    if found is None:
        group = [words for words in COMMANDS if words.startswith(given[0] + " ")]
        known = ", ".join(group or dict.fromkeys(words.split()[0] for words in COMMANDS))
        asks = len(given) > 1 and given[1] in ("-h", "--help")
        print(f"grasp-core: '{' '.join(given[:2])}' is no command; choose one of: {known}", file=sys.stderr)
        return 0 if group and asks else 2
    words, rest = found
    try:
        import tyro

        module, name, _ = COMMANDS[words]
        kind = getattr(importlib.import_module(f"grasp_core.cli.{module}"), name)
        complaint = io.StringIO()
        try:
            with contextlib.redirect_stderr(complaint):
                command = cast(Command, tyro.cli(kind, args=rest, prog=f"grasp-core {words}"))
        except SystemExit as stop:
            if stop.code:
                print(f"grasp-core {words}: {_one_line(complaint.getvalue())}", file=sys.stderr)
                return 2
            raise
        return command.run() or 0
    except (GraspError, KeyboardInterrupt) as error:
        if debug:
            raise
        cancelled = isinstance(error, KeyboardInterrupt | Cancelled)
        print(f"grasp-core: {' '.join(str(error).split()) or 'cancelled'}", file=sys.stderr)
        return 130 if cancelled else 2
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except SystemExit as stop:
        return 0 if stop.code is None else stop.code if isinstance(stop.code, int) else 2
    except Exception as error:
        if debug:
            raise
        print(
            f"grasp-core: {type(error).__name__}: {error} (run again with --debug for the traceback)", file=sys.stderr
        )
        return 1
