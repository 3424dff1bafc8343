import pytest

from grasp_core.dataset.exchange import event_lines, export_events, import_events
from grasp_core.dataset.rows import AttemptRow
from grasp_core.errors import StoreError
from grasp_core.grasp import Grasp


@pytest.fixture
def copies(tmp_path, make_store, make_box, make_record, at_rest):
    """Two copies of one dataset whose scenes were stored in another order, so that ids differ."""
    made = []
    for order in ([0, 1], [1, 0]):
        store = make_store(tmp_path / str(order[0]))
        for index in order:
            asset = make_box(f"box_{index:03d}", (0.05 + 0.01 * index, 0.04, 0.05))
            store.add_object(asset, "train", [at_rest(asset)])
            store.add_scene(make_record(asset, f"{asset.name}-0", seed=index))
        made.append(store)
    yield made
    for store in made:
        store.close()


def labels(store):
    found = store.rows(
        """SELECT scenes.name, number, label, state, attempts, successes, flagged FROM samples
           JOIN grasps ON grasps.id = samples.grasp JOIN scenes ON scenes.id = samples.scene ORDER BY 1, 2"""
    )
    return [tuple(row) for row in found]


def work(store, person):
    grasp = store.grasps(store.scene_id("box_000-0")).id
    store.add_label(int(grasp[0]), person, 0.0, reason="slips", note="the edge")
    store.revert(store.add_label(int(grasp[1]), person, "exclude", batch="b").id, person)
    store.add_label(int(grasp[2]), person, "flag")
    seed = 7 if person == "ann" else 8
    store.add_attempts(int(grasp[3]), [AttemptRow("SUCCESS", seed, (0.0, 0.0, 0.0, 0.0))], person=person)
    own = store.add_grasp(store.scene_id("box_001-0"), Grasp((0.0, 0.01, 0.02), 0.3, 0.08), person=person)
    store.add_label(own, person, 0.75)


def test_work_of_two_people_comes_together_whatever_the_order(copies, tmp_path):
    one, two = copies
    work(one, "ann")
    work(two, "bob")
    assert export_events(one, tmp_path / "one.jsonl") == export_events(two, tmp_path / "two.jsonl") == 6
    first = import_events(one, tmp_path / "two.jsonl")
    second = import_events(two, tmp_path / "one.jsonl")
    assert (first.added, first.known, first.left_out) == (second.added, second.known, second.left_out) == (6, 0, {})
    assert labels(one) == labels(two)
    assert {line.uid for line in event_lines(one)} == {line.uid for line in event_lines(two)}
    assert one.grasps(one.scene_id("box_000-0")).attempts.tolist() == [5, 5, 5, 7]
    again = import_events(one, tmp_path / "two.jsonl")
    assert (again.added, again.known) == (0, 6)
    assert not one.differing_labels() and not two.differing_labels()


def test_the_newest_decision_wins_not_the_last_imported(copies, tmp_path):
    one, two = copies
    grasp = [int(store.grasps(store.scene_id("box_000-0")).id[0]) for store in copies]
    one.add_label(grasp[0], "ann", 0.25)
    export_events(one, tmp_path / "old.jsonl")
    import_events(two, tmp_path / "old.jsonl")
    two.add_label(grasp[1], "bob", 1.0)
    export_events(two, tmp_path / "new.jsonl")
    import_events(one, tmp_path / "new.jsonl")
    assert one.current(grasp[0]).value == two.current(grasp[1]).value == 1.0


def test_foreign_events_are_left_out_and_counted(copies, tmp_path, make_store):
    one, _ = copies
    work(one, "ann")
    export_events(one, tmp_path / "e.jsonl")
    with make_store(tmp_path / "empty") as other:
        result = import_events(other, tmp_path / "e.jsonl")
    assert result.added == 0 and result.left_out == {"its scene is not there": 6}


def test_a_damaged_line_imports_nothing(copies, tmp_path):
    one, two = copies
    work(one, "ann")
    file = tmp_path / "e.jsonl"
    export_events(one, file)
    file.write_bytes(file.read_bytes() + b'{"uid": 5}\n')
    with pytest.raises(StoreError, match="line 7 is no label event"):
        import_events(two, file)
    assert two.events() == []
    with pytest.raises(StoreError, match=r"missing\.jsonl"):
        import_events(two, tmp_path / "missing.jsonl")
    with pytest.raises(StoreError, match="cannot be written"):
        export_events(one, tmp_path / "no" / "folder.jsonl")


def test_a_grasp_that_differs_is_left_out(copies, tmp_path):
    one, two = copies
    one.add_label(1, "ann", 0.0)
    export_events(one, tmp_path / "e.jsonl")
    with two.transaction() as db:
        db.execute("UPDATE grasps SET x = x + 0.01")
    assert import_events(two, tmp_path / "e.jsonl").left_out == {"its grasp differs": 1}
