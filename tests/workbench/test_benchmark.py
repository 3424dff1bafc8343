import os
import subprocess
import sys

import pytest

from grasp_core.errors import GraspError
from workbench import benchmark
from workbench.cli import main


def test_memory_counts_children():
    alone = benchmark.memory_mb(os.getpid())
    with subprocess.Popen([sys.executable, "-c", "x = 'x' * 50_000_000; print(1, flush=True); input()"],
                          stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:  # fmt: skip
        child.stdout.readline()
        assert benchmark.memory_mb(os.getpid()) > alone + 45
        assert benchmark.memory_mb(child.pid) < alone
        child.stdin.close()


def test_without_chromium_it_says_what_is_missing(monkeypatch, capsys):
    monkeypatch.setattr(benchmark.shutil, "which", lambda name: None)
    with pytest.raises(GraspError, match="Chromium"):
        benchmark.chromium()
    assert main(["--benchmark"]) == 2 and "Chromium" in capsys.readouterr().err


def test_too_few_changes_are_refused(capsys):
    assert main(["--benchmark", "--changes", "1"]) == 2 and "--changes" in capsys.readouterr().err
