import subprocess
import sys

from hypothesis import given
from hypothesis import strategies as st

from grasp_core.evaluation.seeds import child_seed, generator
from grasp_core.simulation import trial

WORDS = st.lists(st.one_of(st.text(max_size=6), st.integers(0, 50)), max_size=3)


@given(st.integers(0, 2**63 - 1), WORDS)
def test_no_seed_of_evaluation_can_be_one_that_made_a_label(seed, words):
    label_seed = trial.child_seed(seed % 2**32, 3)
    assert 0 <= label_seed < 2**32 <= 2**62 <= child_seed(seed, *words) < 2**63


@given(st.integers(0, 2**31), st.integers(0, 2**31), WORDS, WORDS)
def test_equal_words_give_equal_seeds_and_others_do_not(seed, other, words, others):
    same = seed == other and words == others
    assert (child_seed(seed, *words) == child_seed(other, *others)) is same


def test_zero_is_a_seed():
    assert child_seed(0, "place") != child_seed(1, "place")
    assert generator(0, "image").random() == generator(0, "image").random() != generator(1, "image").random()


def test_a_number_is_not_its_text():
    assert child_seed(0, "1") != child_seed(0, 1)
    assert child_seed(0, "a", "b") != child_seed(0, "ab")


def test_seeds_are_the_same_in_another_process():
    code = "from grasp_core.evaluation.seeds import child_seed; print(child_seed(7, 'execute', 'mug', 2))"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert int(out) == child_seed(7, "execute", "mug", 2)
