import msgspec
import pytest

from grasp_core.evaluation import cache


class Value(msgspec.Struct, frozen=True):
    numbers: list[float]


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "cache")
    return tmp_path / "cache"


def test_a_value_is_made_once_for_a_key(own_folder):
    made = []

    def make() -> Value:
        made.append(1)
        return Value([0.1 + 0.2])

    for _ in range(3):
        assert cache.remembered("kind", ["a", 1], Value, make) == Value([0.1 + 0.2])
    assert len(made) == 1
    cache.remembered("kind", ["a", 2], Value, make)
    cache.remembered("other", ["a", 1], Value, make)
    assert len(made) == 3
    assert not list(own_folder.rglob("tmp*"))


@pytest.mark.parametrize("spoilt", [b"", b"{", b'{"numbers": "none"}'])
def test_a_spoilt_file_is_made_anew(own_folder, spoilt):
    cache.remembered("kind", 1, Value, lambda: Value([1.0]))
    (file,) = own_folder.rglob("*.json")
    file.write_bytes(spoilt)
    assert cache.remembered("kind", 1, Value, lambda: Value([2.0])) == Value([2.0])
    assert cache.remembered("kind", 1, Value, lambda: Value([3.0])) == Value([2.0])


def test_a_cache_that_cannot_be_written_costs_nothing_but_time(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setattr(cache, "folder", lambda: blocked)
    assert cache.remembered("kind", 1, Value, lambda: Value([1.0])) == Value([1.0])


def test_the_code_digest_follows_the_source(tmp_path, monkeypatch):
    (tmp_path / "simulation").mkdir()
    (tmp_path / "simulation" / "world.py").write_text("a = 1\n")
    (tmp_path / "__init__.py").write_text("")
    monkeypatch.setattr(cache.grasp_core, "__file__", str(tmp_path / "__init__.py"))
    cache.code_digest.cache_clear()
    before = cache.code_digest("simulation")
    (tmp_path / "simulation" / "world.py").write_text("a = 2\n")
    cache.code_digest.cache_clear()
    after = cache.code_digest("simulation")
    assert before != after
    assert cache.code_digest("simulation/world.py") == after
    cache.code_digest.cache_clear()
