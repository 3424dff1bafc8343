from workbench.inspector.draws import draw


def test_seeds_are_fresh_and_in_range():
    drawn = {draw() for _ in range(100)}
    assert len(drawn) > 90 and all(0 <= seed < 2**31 for seed in drawn)
