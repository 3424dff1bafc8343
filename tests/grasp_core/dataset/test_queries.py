import msgspec
import pytest

from grasp_core.dataset.queries import RANGES, Query
from grasp_core.errors import StoreError


@pytest.mark.parametrize("field", ["state", "source", "split", "outcome", "origin", "sort"])
def test_values_that_are_no_choice_are_refused(field):
    with pytest.raises(StoreError, match=f"{field} is one of"):
        Query(**{field: "x' OR 1 --"})


def test_a_query_travels_as_json():
    query = Query(state="excluded", gap=(0.5, 1.0), sort="mistake", descending=True)
    assert msgspec.json.decode(msgspec.json.encode(query), type=Query) == query


def test_ranges_are_fields():
    assert set(RANGES) <= set(Query.__struct_fields__)
