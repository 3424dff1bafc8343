import msgspec
import pytest

from grasp_core.dataset.rows import AttemptRow
from grasp_core.dataset.store import DatasetStore
from grasp_core.dataset.verify import verify
from grasp_core.gripper import load_gripper
from grasp_core.simulation.physics import load_physics


@pytest.fixture
def sound(tmp_path, asset, make_record, at_rest):
    """A dataset made with real physics settings."""
    physics = load_physics()
    with DatasetStore.create(
        tmp_path / "d", name="t", gripper=load_gripper(), physics=physics, recipe=physics
    ) as store:
        store.add_object(asset, "train", [at_rest(asset)])
        store.add_scene(make_record(asset))
        store.add_label(1, "ann", 0.0)
        store.add_label(2, "ann", "exclude")
        store.revert(store.add_attempts(3, [AttemptRow("MISSED", 1, (0.0, 0.0, 0.0, 0.0))]).id, "ann")
        yield store


def problems(store, **options):
    return [f"{finding.where}: {finding.problem}" for finding in verify(store, **options)]


def flip(path, place):
    data = bytearray(path.read_bytes())
    data[place] ^= 4
    path.write_bytes(data)


def test_nothing_is_wrong(sound):
    calls = []
    assert verify(sound, gripper=load_gripper(), physics=load_physics(), progress=lambda *c: calls.append(c)) == []
    assert calls == [(1, 2), (2, 2)]


@pytest.mark.parametrize("folder", ["depth", "objects"])
@pytest.mark.parametrize("place", [40, -20])
def test_a_flipped_bit_is_found(sound, folder, place):
    path = next((sound.path / folder).iterdir())
    flip(path, place)
    found = problems(sound)
    assert len(found) == 1 and path.name in found[0] and "checksum" in found[0]


@pytest.mark.parametrize("folder", ["depth", "objects"])
def test_a_missing_file_is_found(sound, folder):
    path = next((sound.path / folder).iterdir())
    path.unlink()
    found = problems(sound)
    assert len(found) == 1 and path.name in found[0] and "cannot be read" in found[0]


def test_a_stray_file_is_found(sound):
    (sound.path / "depth" / "left-over.png").write_bytes(b"x")
    assert ["left-over.png" in text for text in problems(sound)] == [True]


def test_another_gripper_or_physics_is_found(sound):
    gripper = msgspec.structs.replace(load_gripper(), force=5.0)
    physics = msgspec.structs.replace(load_physics(), friction=0.1)
    found = problems(sound, gripper=gripper, physics=physics)
    assert len(found) == 2 and "gripper" in found[0] and "friction" in found[1]


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ("UPDATE attempts SET outcome = 'SUCCESS' WHERE grasp = 4", "were changed"),
        ("UPDATE samples SET label = 1 WHERE grasp = 1", "differ from the rule"),
        ("UPDATE samples SET label = 0.1 WHERE grasp = 4", "differ from the rule"),
        ("DELETE FROM samples WHERE grasp = 4", "have no row"),
        ("UPDATE meta SET value = json_set(value, '$.friction', 0.9) WHERE key = 'physics'", "physics"),
        ("UPDATE meta SET value = json_set(value, '$.force', 9) WHERE key = 'gripper'", "gripper"),
    ],
)
def test_a_changed_row_is_found(sound, change, word):
    with sound.transaction() as db:
        db.execute(change)
    assert any(word in text for text in problems(sound))


def test_mending_labels(sound):
    with sound.transaction() as db:
        db.execute("UPDATE samples SET label = 1, state = 'labelled'")
        db.execute("DELETE FROM samples WHERE grasp = 4")
    sound.rebuild_labels()
    assert verify(sound) == []
