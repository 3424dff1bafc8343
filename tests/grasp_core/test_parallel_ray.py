"""The map on a real local Ray cluster of two nodes; slow, and skipped without the extra `cluster`."""

import time

import pytest

from grasp_core.dataset.generate import generate
from grasp_core.dataset.recipe import Objects, Recipe
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import GraspError
from grasp_core.parallel import Executor, map_scenes

ray = pytest.importorskip("ray", reason="needs the extra 'cluster' (Ray)")
pytestmark = pytest.mark.slow


@pytest.fixture
def cluster():
    """(cluster, its second node): two nodes with one core each."""
    from ray.cluster_utils import Cluster

    made = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    second = made.add_node(num_cpus=1)
    made.wait_for_nodes()
    yield made, second
    ray.shutdown()
    made.shutdown()


def test_a_killed_node_loses_nothing_and_doubles_nothing(cluster):
    made, second = cluster

    def slow_square(item: int) -> int:  # defined here: it travels by value
        time.sleep(0.5)
        return item * item

    results = []
    for index, value in map_scenes(slow_square, list(range(12)), Executor(ray=made.address)):
        results.append((index, value))
        if len(results) == 2:
            made.remove_node(second, allow_graceful=False)
    assert sorted(results) == [(index, index * index) for index in range(12)]


def test_errors_of_work_come_back(cluster):
    made, _ = cluster
    with pytest.raises(TypeError):
        list(map_scenes(len, [3], Executor(ray=made.address)))


def test_same_dataset_as_local_processes(cluster, tmp_path):
    made, second = cluster
    recipe = Recipe(name="r", train=Objects(families={"box": 2, "can": 1}), poses=2, grid=2, angles=2, attempts=2)
    stored = []

    def progress(seen) -> None:
        stored.append(seen)
        if seen.stage == "scenes" and seen.done == 2:
            made.remove_node(second, allow_graceful=False)

    generate(recipe, tmp_path / "ray", Executor(ray=made.address), progress=progress)
    generate(recipe, tmp_path / "local", Executor(workers=1))
    digests = []
    for name in ("ray", "local"):
        with DatasetStore.open(tmp_path / name, readonly=True) as store:
            digests.append(store.content_digest())
    assert digests[0] == digests[1]


def test_no_cluster_is_a_clear_error():
    with pytest.raises(GraspError, match=r"no Ray cluster answers at '127\.0\.0\.1:1'"):
        list(map_scenes(len, ["a"], Executor(ray="127.0.0.1:1")))
