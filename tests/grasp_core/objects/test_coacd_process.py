import numpy as np
import pytest
import trimesh

from grasp_core.objects.coacd_process import SETTINGS, run_coacd


@pytest.fixture(scope="module")
def ring():
    mesh = trimesh.creation.annulus(0.3, 0.5, 0.2, sections=12)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


@pytest.mark.parametrize("settings", list(SETTINGS))
def test_parts_cover_the_mesh(ring, settings):
    hulls, why = run_coacd(*ring, "off", settings, 6, 60)
    assert why == "" and 3 <= len(hulls) <= 6
    points = np.concatenate(hulls)
    assert np.allclose([points.min(axis=0), points.max(axis=0)], [ring[0].min(axis=0), ring[0].max(axis=0)], atol=0.02)


def test_time_out_and_failure_are_told_apart(ring):
    assert run_coacd(*ring, "off", "coacd", 6, 0.02) == ([], "CoACD took longer than 0.02 s")
    hulls, why = run_coacd(ring[0], ring[1] + 10_000, "off", "coacd", 6, 60)
    assert hulls == [] and why.startswith("CoACD failed (status")


def test_a_limit_of_processor_time_ends_the_process():
    ball = trimesh.creation.icosphere(subdivisions=5)
    noise = np.random.default_rng(0).uniform(0.7, 1.0, (len(ball.vertices), 1))
    assert run_coacd(ball.vertices * noise, ball.faces, "on", "coacd", 8, 1) == ([], "CoACD took longer than 1 s")
