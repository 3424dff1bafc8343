import numpy as np
import pytest

from grasp_core.objects.hulls import convex_part, mass_properties
from grasp_core.objects.parametric.shells import section_at, shell
from grasp_core.objects.parametric.solids import Section


def test_straight_cup_is_hollow_and_its_parts_have_the_walls_volume():
    cup = shell([Section(0, 4), Section(5, 4), Section(10, 4)], 0.4, 0.5)
    exact = np.pi * (16 * 10 - 3.6**2 * 9.5)
    assert cup.body.volume() == pytest.approx(exact, rel=0.02)
    assert len(cup.parts) == 9
    parts = [convex_part(part) for part in cup.parts]
    assert mass_properties(parts).volume == pytest.approx(exact, rel=0.15)
    middle = np.array([[0, 0, 5.0]])
    assert all(
        (middle @ p.mesh.face_normals.T - (p.mesh.face_normals * p.mesh.triangles[:, 0]).sum(1)).max() > 3
        for p in parts
    )


def test_squarish_vessel_has_exact_flat_walls():
    tray = shell([Section(0, 5, 3, 12), Section(4, 5, 3, 12)], 0.5, 0.5)
    parts = mass_properties([convex_part(part) for part in tray.parts]).volume
    assert parts == pytest.approx(tray.body.volume(), rel=0.1)


def test_flared_wall_has_its_thickness_square_to_the_skin():
    dish = shell([Section(0, 2), Section(1.5, 4), Section(3, 6)], 0.4, 0.3, levels=2)
    slope = np.hypot(4, 3)
    middle_ring = 2 * np.pi * 4 * slope * 0.4
    assert dish.body.volume() == pytest.approx(middle_ring + np.pi * 4 * 0.3, rel=0.25)


def test_section_between_two():
    between = section_at([Section(0, 2, 4), Section(2, 4, 6, x=1)], 1)
    assert (between.a, between.b, between.x) == (3, 5, 0.5)
