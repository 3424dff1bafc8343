import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from grasp_core.errors import MeshError
from grasp_core.objects.asset import ObjectAsset, Part

NUMBERS = st.floats(-0.5, 0.5, width=64)


def part(size: tuple[float, float, float] = (0.1, 0.04, 0.02), shift: float = 0.0) -> Part:
    mesh = trimesh.creation.box(size)
    return Part(mesh.vertices + np.array([shift, 0, 0]), np.array(mesh.faces, np.int32))


def asset(**changes) -> ObjectAsset:
    parts = (part(), part((0.02, 0.02, 0.06), 0.06))
    both = trimesh.util.concatenate([p.mesh for p in parts])
    values = {
        "name": "hammer_001",
        "category": "hammer",
        "vertices": np.array(both.vertices),
        "faces": np.array(both.faces, np.int32),
        "parts": parts,
        "volume": 1.04e-4,
        "unit_inertia": np.diag([1e-7, 2e-7, 3e-7]),
        "mass": 0.3,
        "decomposition": "coacd",
        "source": "hammer.obj",
        "meta": {"licence": "CC0 — free"},
    }
    return ObjectAsset(**(values | changes))


def assert_equal(a: ObjectAsset, b: ObjectAsset) -> None:
    for name in ("name", "category", "volume", "mass", "decomposition", "source", "meta", "digest"):
        assert getattr(a, name) == getattr(b, name), name
    for name in ("vertices", "faces", "unit_inertia"):
        left, right = getattr(a, name), getattr(b, name)
        assert left.dtype == right.dtype and np.array_equal(left, right), name
    assert len(a.parts) == len(b.parts)
    for left, right in zip(a.parts, b.parts, strict=True):
        assert np.array_equal(left.vertices, right.vertices) and np.array_equal(left.faces, right.faces)


@settings(max_examples=30)
@given(
    hnp.arrays(np.float64, st.tuples(st.integers(3, 9), st.just(3)), elements=NUMBERS),
    st.lists(
        hnp.arrays(np.float64, st.tuples(st.integers(4, 6), st.just(3)), elements=NUMBERS), min_size=1, max_size=4
    ),
    st.one_of(st.none(), st.floats(1e-3, 10)),
    st.text(st.characters(codec="utf-8", categories=("L", "N", "P")), max_size=12),
)
def test_bytes_round_trip(vertices, parts, mass, source):
    faces = np.array([[0, 1, 2]], np.int32)
    made = tuple(Part(v, np.array([[0, 1, 2], [0, 2, 3]], np.int32)) for v in parts)
    before = asset(vertices=vertices, faces=faces, parts=made, mass=mass, source=source)
    assert_equal(before, ObjectAsset.from_bytes(before.to_bytes()))


def test_the_same_asset_has_the_same_bytes():
    assert asset().to_bytes() == asset().to_bytes()


def test_file_round_trip(tmp_path):
    path = tmp_path / "hammer.npz"
    asset().save(path)
    assert_equal(asset(), ObjectAsset.load(path))


def test_damaged_files_are_refused_by_name(tmp_path):
    path = tmp_path / "hammer.npz"
    with pytest.raises(MeshError, match=r"hammer\.npz: cannot be read"):
        ObjectAsset.load(path)
    whole = asset().to_bytes()
    for data in (b"", b"no asset", whole[: len(whole) // 2]):
        path.write_bytes(data)
        with pytest.raises(MeshError, match=r"hammer\.npz.*import the object again"):
            ObjectAsset.load(path)


def test_another_npz_is_no_asset(tmp_path):
    path = tmp_path / "other.npz"
    np.savez(path, a=np.zeros(3))
    with pytest.raises(MeshError, match="no object asset"):
        ObjectAsset.load(path)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"parts": ()}, "convex part"),
        ({"faces": np.zeros((0, 3), np.int32)}, "needs a mesh"),
        ({"vertices": np.zeros((4, 2))}, "needs a mesh"),
        ({"vertices": np.full((8, 3), np.nan)}, "finite"),
        ({"volume": 0.0}, "no volume"),
        ({"volume": float("nan")}, "no volume"),
        ({"mass": 0.0}, "mass"),
        ({"mass": float("nan")}, "mass"),
    ],
)
def test_what_is_no_object_is_refused_by_name(changes, words):
    with pytest.raises(MeshError, match=words) as caught:
        asset(**changes)
    assert "hammer_001" in str(caught.value)


def test_digest_follows_geometry_and_mass_only():
    same = asset(name="other", category="tool", source="", meta={})
    assert same.digest == asset().digest
    moved = asset().vertices + 1e-9
    assert asset(vertices=moved).digest != asset().digest
    assert asset(parts=(part(), part((0.02, 0.02, 0.05), 0.06))).digest != asset().digest
    assert asset(mass=0.31).digest != asset().digest != asset(mass=None).digest


def test_extents_and_hull_span_the_mesh():
    made = asset()
    assert made.extents == pytest.approx([0.12, 0.04, 0.06])
    assert made.hull.is_watertight
    assert np.ptp(made.hull.vertices, axis=0) == pytest.approx(made.extents)
    assert made.parts[0].mesh.volume == pytest.approx(8e-5)
    assert len(made.mesh.faces) == 24
