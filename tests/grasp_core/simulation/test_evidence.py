import msgspec
import numpy as np
import pytest

from grasp_core.simulation.evidence import (
    Comfort,
    Evidence,
    FingerContact,
    Outcome,
    contact_kind,
    hold_words,
    millimetres,
    triple,
)


def contact(kind: str) -> FingerContact:
    return FingerContact(0, 20.0, 1.5, (-1.0, 0.0, 0.0), (-0.02, 0.0, 0.03), kind)


def test_outcomes_are_written_as_they_are_called():
    assert {outcome.value for outcome in Outcome} == {"SUCCESS", "COLLISION", "MISSED", "SLIPPED", "UNSTABLE"}
    assert all(str(outcome) == outcome.name for outcome in Outcome)


@pytest.mark.parametrize(
    ("points", "kind"),
    [
        ([[0, 0, 0]], "point"),
        ([[0, 0, 0], [0, 0.001, 0.001]], "point"),
        ([[0, -0.008, 0], [0, 0.008, 0]], "edge"),
        ([[0, -0.006, -0.006], [0, 0.006, 0.006]], "edge"),
        ([[0, y, z] for y in (-0.008, 0.008) for z in (0, 0.02)], "face"),
    ],
)
def test_kind_of_contact_by_its_spread_over_the_finger(points, kind):
    assert contact_kind(np.array(points, float)) == kind


def test_spread_along_the_closing_axis_is_none():
    """Faces are measured across the axis: depth of the object between the fingers does not count."""
    assert contact_kind(np.array([[-0.03, 0, 0], [0.03, 0, 0], [0, 0.0005, 0]])) == "point"


@pytest.mark.parametrize(
    ("length", "words"),
    [(0.0004, "0.4 mm"), (0.0029, "2.9 mm"), (0.003, "3 mm"), (0.0296, "30 mm"), (0.083, "8.3 cm"), (-0.05, "-5.0 cm")],
)
def test_lengths_for_people(length, words):
    assert millimetres(length) == words


@pytest.mark.parametrize(
    ("left", "right", "words"),
    [
        ("face", "face", ""),
        (None, None, ""),
        ("edge", "face", "the left finger held an edge"),
        ("face", "point", "the right finger held a point"),
        (None, "edge", "the right finger held an edge"),
        ("edge", "edge", "each finger held an edge only"),
        ("point", "point", "each finger held a point only"),
        ("edge", "point", "the left finger held an edge, the right finger held a point"),
    ],
)
def test_words_about_the_hold(left, right, words):
    assert hold_words(*(contact(kind) if kind else None for kind in (left, right))) == words


def test_triple_gives_plain_rounded_floats():
    values = triple(np.array([1.23456789, -2.0, 1e-9], np.float32))
    assert values == (1.234568, -2.0, 0.0)
    assert all(type(value) is float for value in values)


def test_evidence_and_comfort_go_through_json():
    evidence = Evidence(words="held", object=1, travel=(0.03, 0.031), left=contact("face"), clearance=0.2)
    assert msgspec.json.decode(msgspec.json.encode(evidence), type=Evidence) == evidence
    comfort = Comfort(0.002, 0.1)
    assert msgspec.json.decode(msgspec.json.encode(comfort), type=Comfort) == comfort
