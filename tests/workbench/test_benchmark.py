import subprocess
import sys

import pytest

from grasp_core.errors import GraspError
from workbench import benchmark
from workbench.cli import main


def test_memory_counts_children():
    large = "x = 'x' * 50_000_000; print(1, flush=True); input()"
    parent = f"""import subprocess, sys
print(flush=True); input()
child = subprocess.Popen([sys.executable, "-c", {large!r}])
child.wait()"""
    with subprocess.Popen([sys.executable, "-c", parent], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        process.stdout.readline()
        alone = benchmark.memory_mb(process.pid)
        process.stdin.write(b"\n")
        process.stdin.flush()
        process.stdout.readline()  # of the child, which has its memory now
        assert benchmark.memory_mb(process.pid) > alone + 45
        process.stdin.close()


def test_without_chromium_it_says_what_is_missing(monkeypatch, capsys):
    monkeypatch.setattr(benchmark.shutil, "which", lambda name: None)
    with pytest.raises(GraspError, match="Chromium"):
        benchmark.chromium()
    assert main(["--benchmark"]) == 2 and "Chromium" in capsys.readouterr().err


def test_too_few_changes_are_refused(capsys):
    assert main(["--benchmark", "--changes", "1"]) == 2 and "--changes" in capsys.readouterr().err
