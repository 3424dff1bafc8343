"""What a benchmark ran on: machine, versions, and whether other work disturbed it; the envelope of every benchmark.

watch = Watch()
results = ...                                     # the work
print_envelope(envelope("latency", seed, results, watch), json=True)
"""

from __future__ import annotations

import json as json_
import os
import platform
import sys
import time
from importlib import metadata
from pathlib import Path
from typing import Any

import msgspec

_PACKAGES = (
    "grasp-workbench",
    "numpy",
    "opencv-python-headless",
    "embreex",
    "dartpy",
    "coacd",
    "openvino",
    "torch",
    "mujoco",
    "python-fcl",
)
_BUSY = 0.15
"""Share of all cores that others may use before a benchmark calls the machine busy."""


class Machine(msgspec.Struct, frozen=True):
    """What the numbers were measured on.

    Attributes:
        cpu: the processor's name.
        cores: logical cores that this process may use.
        memory_gb: of the machine, 10⁹ bytes; None where the system does not say.
        system: operating system and architecture.
        other_load: cores that other processes kept busy on average during the run; None where it cannot be told.
        busy: other work took more than 15 % of the machine: times are then no measure of this program.
    """

    cpu: str
    cores: int
    memory_gb: float | None
    system: str
    other_load: float | None
    busy: bool | None


class Watch:
    """Watches, from its making until `stop`, how much of the machine others use (Linux; elsewhere `others` is None).

    Work of a process counts as one's own while it lives and once it was waited for. Programs that end their processes
    without waiting (a browser, for one) have to be watched until just before they end.
    """

    def __init__(self) -> None:
        self._stopped: tuple[float | None] | None = None
        self._wall = time.perf_counter()
        self._all = _busy_seconds()
        self._own = _own_seconds()

    def stop(self) -> None:
        """Look at nothing that comes later: what was started is about to end."""
        self._stopped = (self.others(),)

    def others(self) -> float | None:
        """Cores that other processes kept busy on average since the watch was made, or until it was stopped."""
        if self._stopped is not None:
            return self._stopped[0]
        now, own = _busy_seconds(), _own_seconds()
        wall = time.perf_counter() - self._wall
        if now is None or self._all is None or own is None or self._own is None or wall < 0.05:
            return None
        return max(0.0, ((now - self._all) - (own - self._own)) / wall)

    @property
    def seconds(self) -> float:
        """Wall time since the watch was made."""
        return time.perf_counter() - self._wall


def machine(watch: Watch) -> Machine:
    """Describe this machine, and how busy others kept it while `watch` ran."""
    others = watch.others()
    cores = _cores()
    return Machine(
        cpu=_cpu_name(),
        cores=cores,
        memory_gb=_memory_gb(),
        system=f"{platform.system()} {platform.machine()}",
        other_load=None if others is None else round(others, 2),
        busy=None if others is None else others > _BUSY * cores,
    )


def versions() -> dict[str, str]:
    """Version of Python and of each installed package that matters to the numbers."""
    found = {"python": platform.python_version()}
    for name in _PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def envelope(benchmark: str, seed: int, results: Any, watch: Watch) -> dict[str, Any]:
    """The one object that a benchmark prints: `{"benchmark", "machine", "versions", "seed", "results"}`."""
    return {
        "benchmark": benchmark,
        "machine": msgspec.to_builtins(machine(watch)),
        "versions": versions(),
        "seed": seed,
        "results": msgspec.to_builtins(results),
    }


def print_envelope(report: dict[str, Any], *, json: bool, text: str = "") -> None:
    """Print the envelope as one JSON object on stdout, or `text` for people; say so when the machine was busy."""
    print(json_.dumps(report, ensure_ascii=False) if json else text)
    if report["machine"]["busy"]:
        print(
            f"note: other work kept {report['machine']['other_load']} of {report['machine']['cores']} cores busy;"
            " the times above are slower than this machine can do, so run again when it is idle",
            file=sys.stderr,
        )


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _cpu_name() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _memory_gb() -> float | None:
    try:
        return round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1)
    except (AttributeError, ValueError, OSError):
        return None


def _busy_seconds() -> float | None:
    """CPU seconds that all processes together have used since boot (proc(5), /proc/stat)."""
    try:
        fields = [int(field) for field in Path("/proc/stat").read_text().splitlines()[0].split()[1:9]]
    except (OSError, ValueError, IndexError):
        return None
    user, nice, system, _idle, _iowait, irq, softirq, *_ = fields
    return (user + nice + system + irq + softirq) / os.sysconf("SC_CLK_TCK")


def _own_seconds() -> float | None:
    """CPU seconds of this process, its ended children and its living descendants (proc(5), /proc/[pid]/stat)."""
    children: dict[int, list[int]] = {}
    used: dict[int, int] = {}
    try:
        folders = [entry for entry in os.listdir("/proc") if entry.isdigit()]
    except OSError:
        return None
    for entry in folders:
        try:
            fields = Path(f"/proc/{entry}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        children.setdefault(int(fields[1]), []).append(int(entry))
        used[int(entry)] = sum(map(int, fields[11:15]))
    if os.getpid() not in used:
        return None
    total, queue = 0, [os.getpid()]
    while queue:
        pid = queue.pop()
        total += used[pid]
        queue += children.get(pid, [])
    return total / os.sysconf("SC_CLK_TCK")
