import os
import signal
import subprocess
import sys
import threading

import pytest

from workbench.cli import main


def test_bad_usage_is_status_2(capsys):
    assert main(["--port", "many"]) == 2
    assert main(["--host", "203.0.113.7", "--no-open"]) == 2
    assert "no such address" in capsys.readouterr().err
    assert main(["--port", "70000", "--no-open"]) == 2


def test_help_names_the_contract(capsys):
    assert main(["--help"]) == 0
    shown = capsys.readouterr().out
    for option in ("--host", "--port", "--dataset", "--no-open"):
        assert option in shown


def test_it_prints_its_address_and_ends_on_a_signal(tmp_path):
    command = [sys.executable, "-m", "workbench.cli", "--port", "0", "--no-open", "--dataset", str(tmp_path / "own")]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    ) as process:
        killer = threading.Timer(60, process.kill)
        killer.start()
        try:
            first = process.stdout.readline()
            assert first.startswith("grasp-workbench runs at http://127.0.0.1:") and not first.strip().endswith(":0")
            process.send_signal(signal.SIGTERM)
            assert process.wait(30) == 0
        finally:
            killer.cancel()
            process.kill()


@pytest.mark.parametrize("content", ["not a dataset"])
def test_a_folder_that_is_no_dataset_is_refused(tmp_path, capsys, content):
    (tmp_path / "dataset.sqlite").write_text(content)
    assert main(["--dataset", str(tmp_path), "--no-open", "--port", "0"]) == 2
    assert "dataset" in capsys.readouterr().err
