import msgspec
import pytest

from grasp_core.dataset.queries import Query
from grasp_core.evaluation.curation import FILTERS, SORTS, run_curation
from grasp_core.evaluation.made_dataset import Made, make_dataset


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    with make_dataset(tmp_path_factory.mktemp("made") / "data", Made(samples=3000, decisions=100)) as made:
        yield made


def test_everything_is_timed_and_labels_stay(store):
    before = [tuple(row) for row in store.rows("SELECT label, state FROM samples ORDER BY grasp")]
    told = []
    found = run_curation(store, repeat=2, labels=5, tell=told.append)
    assert [tuple(row) for row in store.rows("SELECT label, state FROM samples ORDER BY grasp")] == before
    assert found.events == 110
    assert set(found.filter_ms) == set(FILTERS) and set(SORTS) <= set(found.page_ms)
    assert 0 < found.label_ms.median_ms <= found.label_ms.most_ms
    assert found.worst_page_ms == max(times.most_ms for times in found.page_ms.values())
    assert "labels" in told


@pytest.mark.parametrize("name", FILTERS)
def test_filters_are_queries(name):
    assert msgspec.structs.asdict(Query(**FILTERS[name])) != msgspec.structs.asdict(Query())


@pytest.mark.parametrize("name", ["outcome", "quality", "score", "by people", "flagged", "excluded", "person", "note"])
def test_filters_find_something(store, name):
    assert 0 < store.count(Query(**FILTERS[name])) < store.count(Query())
