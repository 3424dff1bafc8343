import pytest
from hypothesis import given
from hypothesis import strategies as st

from grasp_core.errors import GraspError
from grasp_core.rates import wilson


@pytest.mark.parametrize(
    ("successes", "attempts", "low", "high"),
    # R. G. Newcombe, Statistics in Medicine 17 (1998), Table I, method 3.
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_wilson_agrees_with_published_intervals(successes, attempts, low, high):
    assert wilson(successes, attempts) == pytest.approx((low, high), abs=5e-5)


@given(st.integers(0, 400), st.integers(1, 400))
def test_wilson_solves_its_defining_equation(successes, attempts):
    successes = min(successes, attempts)
    p, z = successes / attempts, 1.959963984540054
    for bound in wilson(successes, attempts):
        assert 0 <= bound <= 1
        # The ends are where the observed rate is z standard errors of the bound away (Wilson 1927).
        assert (p - bound) ** 2 == pytest.approx(z * z * bound * (1 - bound) / attempts, abs=1e-12)


def test_wilson_without_attempts_knows_nothing():
    assert wilson(0, 0) == (0.0, 1.0)


@pytest.mark.parametrize(("successes", "attempts"), [(-1, 4), (5, 4), (1, 0)])
def test_impossible_counts_are_refused(successes, attempts):
    with pytest.raises(GraspError, match="make no rate"):
        wilson(successes, attempts)
