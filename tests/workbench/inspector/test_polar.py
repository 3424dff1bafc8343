import re
from dataclasses import replace

import numpy as np

from workbench.inspector import polar
from workbench.inspector.orders import Place


def test_every_angle_stands_twice_and_blocked_ones_are_hollow(scores):
    place = Place(5.0, 6.0, 0.66, 0.2, scores(5.0, 6.0))
    page = polar.plot(place, 0.5)
    assert page.count('class="gw-dot"') == 24 and page.count('data-free="0"') == 8
    assert 'data-angles="12"' in page and 'class="gw-least" r="30.0"' in page
    assert page.count('r="3.4"') == 2, "the best angle stands out"


def test_the_plot_is_turned_as_the_image_is(scores):
    place = Place(5.0, 6.0, 0.66, 0.2, scores(5.0, 6.0))
    dots = re.findall(
        r'cx="(-?[\d.]+)" cy="(-?[\d.]+)" r="[\d.]+" fill="[^"]*"><title>φ (-?\d+)°: ([\d.]+)', polar.plot(place, 0.5)
    )
    for x, y, angle, score in dots:
        if float(score) > 0.2:
            seen = np.degrees(np.arctan2(-float(y), float(x)))
            assert abs((seen - float(angle) + 90) % 180 - 90) < 3


def test_what_is_known_is_said(scores):
    place = Place(5.0, 6.0, 0.66, 0.2)
    assert polar.words(place) == "Depth 0.660 m from above, heat 0.20."
    known = replace(place, scores=scores(5.0, 6.0), depth=None)
    said = polar.words(known)
    assert "not measured" in said and "40 mm above" in said and "at 4 of 12 angles" in said and "0.92" in said
    blocked = replace(known.scores, reachable=np.zeros(12, bool))
    assert "at no angle" in polar.words(replace(known, scores=blocked))
