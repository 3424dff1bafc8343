import json

from grasp_core.cli import main
from grasp_core.cli.generate import Bars
from grasp_core.dataset.generate import Progress

RECIPE = "name: one\ntrain: {names: [box_000]}\nposes: 1\ngrid: 2\nangles: 1\nattempts: 1\n"


def test_generate_twice(tmp_path, capsys):
    recipe = tmp_path / "one.yaml"
    recipe.write_text(RECIPE)
    command = ["generate", "--recipe", str(recipe), "--out", str(tmp_path / "d"), "--workers", "0"]
    assert main([*command, "--json"]) == 0
    out, err = capsys.readouterr()
    first = json.loads(out)
    assert first["scenes"] == 1 and sum(first["outcomes"].values()) == 4
    assert "1/1" in err
    assert main(command) == 0
    out = capsys.readouterr().out
    assert "0 scenes made" in out and "1 were there" in out and first["content"] in out


def test_unknown_recipe_lists_the_known(capsys):
    assert main(["generate", "--recipe", "nothing"]) == 2
    assert "smoke" in capsys.readouterr().err


def test_bars_count_from_what_is_done(capsys):
    bars = Bars()
    for progress in (Progress("objects", 1, 2), Progress("objects", 2, 2), Progress("scenes", 0, 3)):
        bars(progress)
    bars.close()
    err = capsys.readouterr().err
    assert "2/2" in err and "0/3" in err
