import numpy as np
import pytest
import trimesh

from grasp_core.errors import MeshError
from grasp_core.objects import decomposition
from grasp_core.objects.decomposition import build_asset, cleaned, decompose


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def assert_closed(parts):
    for part in parts:
        mesh = part.mesh
        assert mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0
        assert len(np.unique(part.faces)) == len(part.vertices)


def ell() -> trimesh.Trimesh:
    long = trimesh.creation.box((0.10, 0.02, 0.02))
    short = trimesh.creation.box((0.02, 0.02, 0.06)).apply_translation((0.04, 0, 0.04))
    return trimesh.util.concatenate([long, short])


def test_convex_mesh_is_one_exact_part():
    found = decompose(trimesh.creation.box((0.1, 0.05, 0.02)))
    assert found.method == "exact: convex"
    assert_closed(found.parts)
    assert found.parts[0].mesh.volume == pytest.approx(1e-4, rel=1e-4)


def test_few_convex_bodies_keep_their_shape_and_their_place():
    found = decompose(ell())
    assert found.method == "exact: 2 convex bodies"
    assert np.allclose(np.concatenate([p.vertices for p in found.parts]).min(axis=0), [-0.05, -0.01, -0.01], atol=1e-6)


def test_many_convex_bodies_are_merged_where_that_adds_little():
    steps = [trimesh.creation.box((0.011, 0.02, 0.02)).apply_translation((0.01 * i, 0, 0)) for i in range(12)]
    upright = [trimesh.creation.box((0.02, 0.02, 0.011)).apply_translation((0, 0, 0.03 + 0.01 * i)) for i in range(5)]
    found = decompose(trimesh.util.concatenate([*steps, *upright]), max_parts=2)
    assert found.method == "merged: 17 convex bodies into 2 parts"
    assert_closed(found.parts)
    assert sum(part.mesh.volume for part in found.parts) == pytest.approx(0.121 * 4e-4 + 0.051 * 4e-4, rel=0.01)


def test_concave_mesh_is_cut_the_same_way_every_time(tmp_path, monkeypatch):
    ring = trimesh.creation.annulus(0.03, 0.05, 0.02, sections=16)
    first = decompose(ring)
    assert first.method == f"cut: {len(first.parts)} parts"
    assert 6 <= len(first.parts) <= 32
    assert max(len(part.vertices) for part in first.parts) <= 24
    assert_closed(first.parts)
    assert first.fidelity.error < 0.0006 and first.fidelity.filled == 0
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "other"))
    again = decompose(ring)
    assert all(np.array_equal(a.vertices, b.vertices) for a, b in zip(first.parts, again.parts, strict=True))
    bigger = decompose(ring.copy().apply_scale(2.0))
    assert np.allclose(bigger.parts[0].vertices, first.parts[0].vertices * 2, atol=1e-9)
    assert bigger.fidelity.error == pytest.approx(2 * first.fidelity.error)


def test_coacd_is_asked_when_the_others_stand_far_off_and_the_least_error_wins(monkeypatch):
    ring = trimesh.creation.annulus(0.03, 0.05, 0.02, sections=16)
    asked = []

    def no_coacd(vertices, faces, preprocess, settings, max_parts, timeout_s):
        asked.append((preprocess, settings, max_parts, timeout_s))
        return [], "CoACD took longer than 1 s"

    monkeypatch.setattr(decomposition, "run_coacd", no_coacd)
    decompose(ring, timeout_s=2.0)
    assert asked == []
    found = decompose(ring, max_parts=2, timeout_s=2.0)
    assert asked == [("off", "coacd", 2, 1.0), ("on", "coacd, coarse", 2, 1.0)]
    assert found.method.startswith("cut: ") and found.method.endswith("; CoACD took longer than 1 s")
    good = [part.vertices / 0.1 + [0.5, 0.5, 0.1] for part in decompose(ring).parts]
    monkeypatch.setattr(decomposition, "run_coacd", lambda *_: (good, ""))
    assert decompose(ring, max_parts=2, timeout_s=3.0).method == f"coacd: {len(good)} parts"


def test_second_call_reads_the_cache(monkeypatch):
    ring = trimesh.creation.annulus(0.03, 0.05, 0.02, sections=16)
    first = decompose(ring)
    monkeypatch.setattr(decomposition, "cut", lambda *_: pytest.fail("was not read from the cache"))
    again = decompose(ring)
    assert again.method == first.method and again.fidelity == first.fidelity
    assert all(np.array_equal(a.vertices, b.vertices) for a, b in zip(first.parts, again.parts, strict=True))


def test_an_asset_tells_how_far_its_parts_stand_off():
    bowl = trimesh.creation.annulus(0.03, 0.05, 0.02, sections=16)
    made = build_asset("ring", "ring", bowl)
    assert float(made.meta["parts_off_mm"]) < 0.6 and made.meta["parts_filled"] == "0.000"
    assert "parts_off_mm" not in build_asset("ring", "ring", bowl, parts=[bowl.vertices]).meta


def test_asset_has_its_origin_at_the_centre_of_mass_and_exact_inertia():
    box = trimesh.creation.box((0.1, 0.04, 0.02)).apply_translation((1.0, 2.0, 3.0))
    asset = build_asset("b", "box", box)
    assert np.allclose(asset.vertices.mean(axis=0), 0, atol=1e-6)
    assert asset.volume == pytest.approx(8e-5, rel=1e-4)
    expected = asset.volume / 12 * np.array([0.04**2 + 0.02**2, 0.1**2 + 0.02**2, 0.1**2 + 0.04**2])
    assert np.allclose(np.diag(asset.unit_inertia), expected, rtol=1e-4)


def test_overlapping_parts_count_once():
    a = trimesh.creation.box((0.1, 0.02, 0.02))
    b = trimesh.creation.box((0.02, 0.1, 0.02))
    asset = build_asset("cross", "cross", trimesh.util.concatenate([a, b]), parts=[a.vertices, b.vertices])
    assert asset.volume == pytest.approx(2 * 4e-5 - 8e-6, rel=1e-4)


def test_densities_move_the_centre_but_keep_the_volume():
    a = trimesh.creation.box((0.02, 0.02, 0.02))
    b = a.copy().apply_translation((0.02, 0, 0))
    mesh = trimesh.util.concatenate([a, b])
    asset = build_asset("h", "hammer", mesh, parts=[a.vertices, b.vertices], densities=[3, 1])
    assert asset.vertices[:, 0].min() == pytest.approx(-0.015, abs=1e-9)
    assert asset.volume == pytest.approx(1.6e-5, rel=1e-6)
    half = asset.volume / 2
    expected = 1.5 * half * 0.005**2 + 0.5 * half * 0.015**2 + 2 * half * 0.02**2 / 6
    assert asset.unit_inertia[1, 1] == pytest.approx(expected, rel=1e-3)


def test_badly_wound_and_open_meshes_still_get_outward_parts():
    inside_out = trimesh.creation.box((0.1, 0.05, 0.02))
    inside_out.invert()
    assert_closed(decompose(inside_out).parts)
    opened = trimesh.creation.box((0.1, 0.05, 0.02))
    opened.update_faces(np.arange(len(opened.faces)) > 1)
    assert_closed(decompose(opened, timeout_s=0.05).parts)


def test_a_sheet_becomes_a_thin_plate():
    sheet = trimesh.Trimesh([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]], [[0, 1, 2], [0, 2, 3]])
    found = decompose(sheet, timeout_s=0.05)
    assert_closed(found.parts)
    # 1 mm from its hull, a little more where CoACD is done before its time is up
    thickness = np.ptp(np.concatenate([part.vertices for part in found.parts])[:, 2])
    assert 0.99e-3 < thickness < 3e-3


@pytest.mark.parametrize(
    ("mesh", "says"),
    [
        (trimesh.Trimesh(np.zeros((3, 3)), np.zeros((0, 3), int), process=False), "no faces"),
        (trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]], [[0, 1, 2]], process=False), "not finite"),
        (trimesh.Trimesh(np.zeros((3, 3)), [[0, 1, 2]], process=False), "degenerate"),
    ],
)
def test_unusable_meshes_are_refused_with_the_reason(mesh, says):
    with pytest.raises(MeshError, match=says):
        cleaned(mesh)
