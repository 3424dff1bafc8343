import numpy as np
import pytest

from grasp_core.camera import Camera, CameraIntrinsics, look_down
from grasp_core.sensing.rays import pixel_rays


@pytest.mark.parametrize("distortion", [None, (0.08, -0.03, 0.001, -0.002, 0.01)])
def test_rays_agree_with_deprojection(distortion):
    intrinsics = CameraIntrinsics(310, 305, 80.2, 61.7, 160, 120, distortion)
    camera = Camera(intrinsics, look_down(0.6, tilt=0.3))
    v, u = np.mgrid[:120, :160]
    points = camera.deproject(np.stack([u, v], axis=-1), np.full((120, 160), 0.8))
    rays = pixel_rays(intrinsics)
    assert np.allclose(0.8 * rays @ camera.pose[:3, :3].T + camera.pose[:3, 3], points, atol=1e-6)


def test_rays_are_made_once_and_cannot_be_changed():
    intrinsics = CameraIntrinsics(100, 100, 1, 1, 3, 4)
    rays = pixel_rays(intrinsics)
    assert rays is pixel_rays(intrinsics) and rays.shape == (4, 3, 3)
    with pytest.raises(ValueError, match="read-only"):
        rays[0, 0, 0] = 1
