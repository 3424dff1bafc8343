"""grasp-workbench: starts the workbench, prints its address, opens the browser."""

from __future__ import annotations

import logging
import signal
import sys
import threading
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Annotated

import tyro

from grasp_core.errors import GraspError


@dataclass(frozen=True)
class Arguments:
    """Open the browser workbench."""

    host: str = "127.0.0.1"
    """Address to bind; any but the loopback one asks browsers for a token."""
    port: int = 8080
    """Wanted port; the next free one is taken when it is busy, 0 lets the system choose."""
    dataset: Path | None = None
    """Folder of the dataset that verdicts go to; by default the user's own."""
    benchmark: bool = False
    """Measure speed and memory in a headless Chromium, print the report, and end."""
    json: bool = False
    """Print the report of --benchmark as one JSON object."""
    changes: int = 200
    """Scenes that --benchmark opens to see whether the memory stays flat."""
    open: Annotated[bool, tyro.conf.arg(help="Open the browser (--no-open: only print the address).")] = True


def main(arguments: Sequence[str] | None = None) -> int:
    """Run until interrupted; exit status 0 done, 2 bad input or usage, 1 anything else."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in given
    try:
        chosen = tyro.cli(Arguments, args=[word for word in given if word != "--debug"], prog="grasp-workbench")
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else 2
    logging.basicConfig(level=logging.WARNING, format="%(name)s: %(message)s")
    if chosen.benchmark:
        return _measure(chosen, debug)
    ended = threading.Event()

    def end(signum: int, frame: FrameType | None) -> None:
        ended.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, end)
    try:
        from workbench.app import Workbench

        workbench = Workbench(chosen.host, chosen.port, chosen.dataset)
    except GraspError as error:
        if debug:
            raise
        print(f"grasp-workbench: {error}", file=sys.stderr)
        return 2
    except Exception as error:
        if debug:
            raise
        print(
            f"grasp-workbench: {type(error).__name__}: {error} (run again with --debug for the traceback)",
            file=sys.stderr,
        )
        return 1
    print(f"grasp-workbench runs at {workbench.url}", flush=True)
    print(f"verdicts go to {workbench.dataset}; Ctrl+C ends it", flush=True)
    if chosen.open:
        webbrowser.open(workbench.url)
    ended.wait()
    workbench.close()
    return 0


def _measure(chosen: Arguments, debug: bool) -> int:
    from dataclasses import asdict

    from grasp_core.evaluation.machine import Watch, envelope, print_envelope
    from workbench.benchmark import run

    watch = Watch()
    try:
        if chosen.changes < 4:
            raise GraspError(f"--changes must be at least 4, not {chosen.changes}")
        result = run(chosen.changes, watch)
    except GraspError as error:
        if debug:
            raise
        print(f"grasp-workbench: {error}", file=sys.stderr)
        return 2
    found = asdict(result)
    lines = "\n".join(f"{name.replace('_', ' '):28s} {value}" for name, value in found.items())
    print_envelope(envelope("workbench", 0, found, watch), json=chosen.json, text=lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
