from dataclasses import replace

import numpy as np

from grasp_core.objects.parametric import make
from grasp_core.objects.sheet import picture, sheet


def test_picture_shows_the_object_in_the_middle():
    image = picture(make("box", 0), 120)
    assert image.shape == (120, 120, 3) and image.dtype == np.uint8
    assert (image[50:70, 50:70] < 250).all()
    assert (image[:4] == 255).all()


def test_parts_are_drawn_in_several_colours():
    image = picture(make("cup", 0), 120, parts=True)
    hues = {tuple(np.argsort(pixel)) for pixel in image[image.min(axis=2) < 200]}
    assert len(hues) >= 3


def test_sheet_has_a_cell_for_every_object():
    assets = [make("box", seed) for seed in range(5)]
    image = sheet(assets, columns=3, size=100)
    assert image.shape == (2 * 149, 300, 3)
    assert (image[149:249, 200:] == 255).all()


def test_captions_stay_in_their_cell():
    long = replace(make("box", 0), name="a_name_that_is_far_too_long_for_so_small_a_cell")
    image = sheet([long, make("box", 1)], columns=2, size=100)
    caption = image[100:115]
    assert (caption[:, 4:90] < 200).any()
    assert (caption[:, 97:103] == 255).all()
    assert (sheet([long, long], columns=1, size=100)[:149] == image[:, :100]).all()
