import time

import pytest

from grasp_core.planning.stages import Stages


def test_stages_add_up_in_order():
    stages = Stages()
    for name in ("one", "two", "one"):
        with stages.stage(name):
            time.sleep(0.01)
    assert list(stages.ms) == ["one", "two"]
    assert stages.ms["one"] >= 19 and stages.ms["two"] >= 9
    assert stages.elapsed_ms >= sum(stages.ms.values()) - 1


def test_a_stage_that_fails_is_counted():
    stages = Stages()
    with pytest.raises(ValueError, match="x"), stages.stage("one"):
        raise ValueError("x")
    assert "one" in stages.ms


def test_a_budget_allows_what_fits():
    assert Stages().allows(1e9)
    stages = Stages(1000)
    assert stages.allows(500) and not stages.allows(1001)
    assert not Stages(0.001).allows(1)
