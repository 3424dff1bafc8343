import importlib
import json
import subprocess
import sys
import types
from dataclasses import dataclass, is_dataclass

import pytest

from grasp_core import cli
from grasp_core.errors import Cancelled, ConfigError


@dataclass(frozen=True)
class Probe:
    """Does what it is told.

    Attributes:
        behave: what to do.
        times: how often.
    """

    behave: str = "well"
    times: int = 1

    def run(self) -> int | None:
        match self.behave:
            case "badly":
                raise ConfigError("file.yaml: depth: is a word; give a number")
            case "cancelled":
                raise Cancelled("stopped; 3 of 7 scenes are kept")
            case "interrupted":
                raise KeyboardInterrupt
            case "broken":
                raise RuntimeError("a bug")
            case "pipe":
                raise BrokenPipeError
            case "exit":
                raise SystemExit
            case "five":
                return 5
        print(json.dumps({"times": self.times}))
        return None


@pytest.fixture(autouse=True)
def commands(monkeypatch):
    module = types.ModuleType("grasp_core.cli.probe")
    module.Probe = Probe  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "grasp_core.cli.probe", module)
    monkeypatch.setattr(
        cli,
        "COMMANDS",
        {"probe": ("probe", "Probe", "one word"), "set probe": ("probe", "Probe", "two words")},
    )


@pytest.mark.parametrize("words", [["probe"], ["set", "probe"]])
def test_commands_of_one_and_two_words_run(words, capsys):
    assert cli.main([*words, "--times", "3"]) == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out) == {"times": 3} and captured.err == ""


@pytest.mark.parametrize(
    ("behave", "status", "words"),
    [
        ("badly", 2, "file.yaml: depth"),
        ("cancelled", 130, "3 of 7"),
        ("interrupted", 130, "cancelled"),
        ("broken", 1, "--debug"),
        ("five", 5, ""),
        ("exit", 0, ""),
    ],
)
def test_exit_status_and_one_line_on_stderr(behave, status, words, capsys):
    assert cli.main(["probe", "--behave", behave]) == status
    captured = capsys.readouterr()
    assert captured.out == "" and words in captured.err and "Traceback" not in captured.err
    assert captured.err.count("\n") <= 1


@pytest.mark.parametrize(("behave", "kind"), [("badly", ConfigError), ("broken", RuntimeError)])
def test_debug_shows_the_traceback(behave, kind):
    with pytest.raises(kind):
        cli.main(["probe", "--debug", "--behave", behave])


@pytest.mark.parametrize("arguments", [["probe", "--no-such"], ["probe", "--times", "often"]])
def test_wrong_options_are_usage_errors(arguments, capsys):
    assert cli.main(arguments) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("grasp-core probe: ") and arguments[1] in printed.err
    assert printed.err.count("\n") == 1


@pytest.mark.parametrize("arguments", [["prob"], ["set"], ["set", "nothing"], ["--times", "3"]])
def test_unknown_commands_list_the_known_ones(arguments, capsys):
    assert cli.main(arguments) == 2
    assert "set" in capsys.readouterr().err


def test_help_lists_the_commands(capsys):
    assert cli.main(["--help"]) == 0
    text = capsys.readouterr().out
    assert "set probe" in text and "two words" in text
    assert cli.main([]) == 2


def test_help_of_a_command_shows_its_options(capsys):
    assert cli.main(["probe", "--help"]) == 0
    text = capsys.readouterr().out
    assert "--times" in text and "how often" in text and "grasp-core probe" in text


def test_a_reader_that_went_away_is_no_error():
    code = (
        "import dataclasses, sys, types\n"
        "from grasp_core import cli\n"
        "@dataclasses.dataclass\n"
        "class Loud:\n"
        "    def run(self):\n"
        "        for _ in range(100000): print('x' * 100)\n"
        "sys.modules['grasp_core.cli.loud'] = m = types.ModuleType('loud'); m.Loud = Loud\n"
        "cli.COMMANDS['loud'] = ('loud', 'Loud', '')\n"
        "sys.exit(cli.main(['loud']))\n"
    )
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None and process.stderr is not None
    process.stdout.readline()
    process.stdout.close()
    errors = process.stderr.read()
    assert process.wait() == 0 and errors == b""


def test_every_command_exists_with_help_and_run(monkeypatch):
    monkeypatch.undo()
    for words, (module, name, text) in cli.COMMANDS.items():
        kind = getattr(importlib.import_module(f"grasp_core.cli.{module}"), name)
        assert is_dataclass(kind) and callable(kind.run), words
        assert kind.__doc__ and text and 1 <= len(words.split()) <= 2, words
        assert kind.__dataclass_params__.frozen, words


def test_usage_needs_no_heavy_imports():
    code = "import sys; from grasp_core import cli; cli.main(['--help']); print(sorted(set(sys.modules) & HEAVY))"
    code = code.replace("HEAVY", "{'numpy', 'torch', 'tyro', 'openvino', 'dartpy', 'cv2', 'trimesh'}")
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.splitlines()[-1] == "[]"
