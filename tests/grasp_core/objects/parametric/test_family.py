import numpy as np
import pytest
import trimesh

from grasp_core.errors import MeshError
from grasp_core.objects.hulls import solid
from grasp_core.objects.parametric import FAMILIES, make

NEEDED = ["cup", "mug", "donut", "banana", "bottle", "bowl", "box", "can", "hammer", "pen", "phone", "plate"]


def outside(points, asset):
    """Lower bound of each point's distance outside all parts, metres."""
    best = np.full(len(points), np.inf)
    for part in asset.parts:
        mesh = part.mesh
        planes = points @ mesh.face_normals.T - (mesh.face_normals * mesh.triangles[:, 0]).sum(axis=1)
        best = np.minimum(best, planes.max(axis=1))
    return np.clip(best, 0, None)


def test_the_catalogue_is_wide():
    assert set(NEEDED) <= set(FAMILIES)
    assert len(FAMILIES) >= 100
    groups = {family.group for family in FAMILIES.values()}
    assert {"kitchen", "tools", "toys", "office", "bathroom", "fruit", "machine"} <= groups


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_no_shape_falls_apart(name):
    kind = FAMILIES[name]
    for seed in range(2):
        volumes = [one.volume() for one in kind.build(np.random.default_rng(seed)).body.decompose()]
        assert sum(volumes) - max(volumes) < 0.01 * max(volumes)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_every_family_makes_sound_objects(name, seed):
    asset = make(name, seed)
    assert asset.name == f"{name}_{seed:03d}" and asset.category == name
    body = solid(asset.vertices, asset.faces)
    assert asset.mesh.is_watertight and asset.mesh.volume > 0
    assert len(body.decompose()) == 1
    assert 0.06 <= asset.extents.max() <= 0.2001
    assert FAMILIES[name].shortest - 1e-9 <= asset.extents.max() <= FAMILIES[name].longest + 1e-9
    assert 1 <= len(asset.parts) <= 20
    for part in asset.parts:
        assert len(part.vertices) <= 24
        assert part.mesh.is_watertight and part.mesh.is_winding_consistent and part.mesh.volume > 0
    assert np.linalg.eigvalsh(asset.unit_inertia).min() > 0


@pytest.mark.parametrize("seed", [0])
@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_parts_follow_what_is_seen(name, seed):
    asset = make(name, seed)
    points, _ = trimesh.sample.sample_surface(asset.mesh, 800, seed=0)
    away = outside(points, asset)
    assert away.mean() < 0.0016
    assert np.quantile(away, 0.98) < 0.007
    seen = solid(asset.vertices, asset.faces).volume()
    assert 0.8 < asset.volume / seen < 1.7


def test_same_seed_same_object_and_other_seed_another():
    first = make("mug", 3)
    make.cache_clear()
    assert make("mug", 3).digest == first.digest
    assert make("mug", 4).digest != first.digest


def test_the_head_of_a_hammer_is_heavier_than_its_handle():
    hammer = make("hammer", 1)
    assert hammer.vertices[:, 0].max() < -0.8 * hammer.vertices[:, 0].min()


def test_unknown_families_and_negative_seeds_are_refused():
    with pytest.raises(MeshError, match=r"no family is called 'mugg'; choose one of: .*mug"):
        make("mugg", 0)
    with pytest.raises(MeshError, match="0 or above"):
        make("mug", -1)
