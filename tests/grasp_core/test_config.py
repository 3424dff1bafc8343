import math
from pathlib import Path

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from grasp_core import config
from grasp_core.errors import ConfigError, GraspError


class Inner(config.Settings):
    depth: float
    mode: str = "plain"


class Outer(config.Settings):
    name: str
    count: int
    rate: float
    flag: bool = False
    inner: Inner | None = None
    sizes: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.count < 0:
            raise ValueError("count must not be negative")
        if self.rate > 1e6:
            raise GraspError("rate is beyond reason")


GOOD = "name: a\ncount: 3\nrate: 0.5\n"


def decode(folder: Path, text: str) -> Outer:
    path = folder / "settings.yaml"
    path.write_text(text)
    return config.load("cameras", path, Outer)


def test_settings_decode_with_defaults(tmp_path):
    assert decode(tmp_path, GOOD) == Outer(name="a", count=3, rate=0.5)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 1e-3),
        ("1E3", 1e3),
        ("-2.5e+2", -250.0),
        (".5", 0.5),
        ("3.", 3.0),
        ("7", 7.0),
        ("-1", -1.0),
        ("+2e2", 200.0),
    ],
)
def test_numbers_as_people_write_them(tmp_path, text, value):
    assert decode(tmp_path, GOOD.replace("0.5", text)).rate == value


@given(st.floats(-1e5, 1e5))
def test_every_number_that_python_prints_is_read_back(value):
    assert config.yaml.load(repr(value), Loader=config._Loader) == value
    assert config.yaml.load(f"{value:e}", Loader=config._Loader) == float(f"{value:e}")


@pytest.mark.parametrize("word", ["on", "off", "yes", "no", "2020-01-01", "1:30", "010", "y"])
def test_words_stay_words(tmp_path, word):
    assert decode(tmp_path, GOOD.replace("name: a", f"name: {word}")).name == word


@pytest.mark.parametrize("number", ["010", "1:30", "1_000", ".nan", "1e", "0o7", "yes", "'3'", "[3]", "3.0 m"])
def test_what_is_no_plain_number_is_refused_as_one(tmp_path, number):
    with pytest.raises(ConfigError, match=r"settings\.yaml.*`\$\.rate`"):
        decode(tmp_path, GOOD.replace("0.5", number))


@pytest.mark.parametrize(("word", "value"), [("true", True), ("False", False)])
def test_booleans(tmp_path, word, value):
    assert decode(tmp_path, GOOD + f"flag: {word}\n").flag is value


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (GOOD + "speed: 3\n", r"unknown field `speed`.*keys there are: name, count, rate"),
        (GOOD + "inner: {depth: 1, wide: 2}\n", r"unknown field `wide`.*\$\.inner.*keys there are: depth, mode"),
        ("name: a\ncount: 3\n", "missing required field `rate`"),
        (GOOD.replace("3", "3.5"), r"Expected `int`.*\$\.count"),
        (GOOD.replace("0.5", "fast"), r"Expected `float`.*\$\.rate"),
        (GOOD.replace("0.5", "true"), r"Expected `float`.*\$\.rate"),
        (GOOD + "inner: {depth: deep}\n", r"\$\.inner\.depth"),
        (GOOD + "sizes: [1, two]\n", r"\$\.sizes"),
        (GOOD + "flag: yes\n", r"Expected `bool`.*\$\.flag"),
        (GOOD.replace("3", "-3"), "count must not be negative"),
        (GOOD.replace("0.5", "1e9"), "beyond reason"),
        ("- name\n- count\n", "Expected `object`"),
        ("", "is empty.*name, count, rate"),
        ("# only a comment\n", "is empty"),
    ],
)
def test_wrong_settings_are_refused_by_file_and_key(tmp_path, text, words):
    with pytest.raises(ConfigError, match=words) as caught:
        decode(tmp_path, text)
    assert str(caught.value).startswith(str(tmp_path / "settings.yaml"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (GOOD + "rate: 0.6\n", r"line 4.*'rate' stands twice"),
        (GOOD + "inner: {depth: 1, depth: 2}\n", r"line 4.*'depth' stands twice"),
        (GOOD + "? [a, b]\n: 1\n", r"line 4.*plain word"),
        (GOOD + "<<: {flag: true}\n", "line 4.*'<<'"),
        (GOOD + "bad: [1, 2\n", r"line \d"),
        (GOOD + "a: b: c\n", "line 4"),
        (GOOD + "--- \nname: b\n", r"line \d"),
        (GOOD + "inner: !!python/object:os.system {}\n", "line 4"),
    ],
)
def test_wrong_yaml_is_refused_by_file_and_line(tmp_path, text, words):
    with pytest.raises(ConfigError, match=words) as caught:
        decode(tmp_path, text)
    assert "settings.yaml" in str(caught.value)


def test_bytes_that_are_no_text_are_refused(tmp_path):
    path = tmp_path / "settings.yaml"
    path.write_bytes(b"name: \xff\xfe\x00a")
    with pytest.raises(ConfigError, match="is not YAML"):
        config.read_yaml(path)


def test_an_unreadable_file_says_so(tmp_path):
    with pytest.raises(ConfigError, match="cannot be read"):
        config.read_yaml(tmp_path)  # a folder


def test_names_are_shipped_and_arguments_in_yaml_are_paths(tmp_path, monkeypatch):
    assert config.locate("grippers", "paper").name == "paper.yaml"
    monkeypatch.chdir(tmp_path)
    (tmp_path / "paper.yaml").write_text(GOOD)
    assert config.locate("grippers", "paper.yaml").resolve() == tmp_path / "paper.yaml"
    assert config.locate("grippers", "paper").resolve() != tmp_path / "paper.yaml"
    (tmp_path / "short.yml").write_text(GOOD)
    assert config.locate("grippers", "short.yml").name == "short.yml"


def test_unknown_names_and_missing_files_list_the_choices():
    with pytest.raises(ConfigError, match=r"'papr'.*paper.*ends in \.yaml"):
        config.locate("grippers", "papr")
    with pytest.raises(ConfigError, match=r"nowhere\.yaml: no such file.*paper"):
        config.locate("grippers", "nowhere.yaml")


def test_settings_are_frozen():
    settings = Outer(name="a", count=1, rate=0.5)
    with pytest.raises(AttributeError):
        settings.count = 2  # type: ignore[misc]


def test_equal_settings_have_equal_digests():
    whole = Outer(name="a", count=1, rate=1, sizes=(1, 2))
    split = Outer(name="a", count=1, rate=1.0, sizes=(1.0, 2.0))
    assert whole == split and config.digest(whole) == config.digest(split)
    assert config.digest(whole) != config.digest(msgspec.structs.replace(whole, rate=math.nextafter(1, 2)))
    assert config.digest(whole) != config.digest(msgspec.structs.replace(whole, name="b"))


def test_a_digest_is_the_same_on_every_machine():
    assert config.digest(Inner(depth=0.25)) == "26531c8b2516"


def test_every_shipped_file_is_a_mapping_of_words():
    root = Path(config.locate("grippers", "paper")).parent.parent
    files = sorted(root.rglob("*.y*ml"))
    assert files
    for path in files:
        read = config.read_yaml(path)
        assert isinstance(read, dict) and all(isinstance(key, str) for key in read), path
        assert path.suffix == ".yaml" and path.parent.parent == root, f"{path}: kind/name.yaml is the only place"
