import numpy as np
import pytest
import trimesh

from grasp_core.objects.fidelity import fidelity, signed_distance
from grasp_core.objects.pieces import SHEET, cut, thickened


def shade() -> trimesh.Trimesh:
    """A lamp's shade: a cone's side without thickness, open above and below, 1 wide."""
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(24)], axis=1)
    vertices = np.concatenate([ring * 0.5, ring * 0.25 + [0, 0, 0.6]])
    i = np.arange(24)
    j = (i + 1) % 24
    return trimesh.Trimesh(vertices, np.concatenate([np.stack([i, j, j + 24], 1), np.stack([i, j + 24, i + 24], 1)]))


def test_a_shade_stays_open_and_its_sheet_becomes_solid():
    parts = cut(shade(), 16)
    assert 6 <= len(parts) <= 16
    inside = np.array([[0, 0, 0.1], [0, 0, 0.3], [0, 0, 0.5], [0.2, 0, 0.1]])
    assert (signed_distance(inside, parts) > 0.03).all()
    assert fidelity(shade(), parts).error < 0.015
    for part in parts:
        mesh = part.mesh
        assert mesh.is_watertight and mesh.volume > 0 and len(part.vertices) <= 24


def test_more_parts_stand_closer():
    few, many = (fidelity(shade(), cut(shade(), count)) for count in (2, 24))
    assert many.error < few.error / 2


def test_convex_bodies_that_overlap_are_not_cut_in_vain():
    one = trimesh.creation.box((1, 0.3, 0.3))
    two = trimesh.creation.box((0.3, 0.3, 1)).apply_translation((0.35, 0, 0.35))
    parts = cut(trimesh.util.concatenate([one, two]), 24)
    assert 2 <= len(parts) <= 4
    assert sum(part.mesh.volume for part in parts) == pytest.approx(0.09 + 0.09 - 0.027, rel=0.1)


def test_flat_points_are_widened_along_their_normal_only():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    assert np.allclose(np.ptp(thickened(square, SHEET), axis=0), [1, 1, SHEET])
    line = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0, 0.0]])
    assert np.allclose(np.sort(np.ptp(thickened(line, SHEET), axis=0)), [SHEET, SHEET, 1], atol=1e-9)
    thick = trimesh.creation.box((1, 1, 0.1)).vertices
    assert len(thickened(np.asarray(thick), SHEET)) == len(thick)
