from grasp_core.cli import main


def test_a_missing_dataset_is_one_line(tmp_path, capsys):
    assert main(["benchmark", "mending", "--dataset", str(tmp_path / "no"), "--out", str(tmp_path / "out")]) == 2
    assert "holds no dataset" in capsys.readouterr().err


def test_impossible_numbers_are_one_line(tmp_path, capsys):
    command = ["benchmark", "mending", "--dataset", str(tmp_path), "--out", str(tmp_path / "out")]
    assert main([*command, "--spoil", "0.9"]) == 2
    assert "spoil lies in" in capsys.readouterr().err
