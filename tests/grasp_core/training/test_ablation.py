from collections.abc import Callable
from pathlib import Path

import pytest
import torch

from grasp_core.errors import ConfigError
from grasp_core.gripper import load_gripper
from grasp_core.training.ablation import BASE, Ablation, run_ablation, variant_settings
from grasp_core.training.corpus import Corpus
from grasp_core.training.scenes import TrainingScene, Views

Toys = Callable[[int, int], list[TrainingScene]]


def ablation(**variants: dict) -> Ablation:
    return Ablation("refined", "refined", 1, variants)


def test_variants_change_what_they_say_and_nothing_else() -> None:
    made = variant_settings(ablation(narrow={"width": 8}, small={"crop": {"size": 32}}, plain={"views": {"count": 0}}))
    base = made[BASE]
    assert list(made) == [BASE, "narrow", "small", "plain"] and base.schedule.epochs == 1
    assert made["narrow"].width == 8 and made["narrow"].crop == base.crop
    assert (made["small"].crop.size, made["small"].crop.context) == (32, base.crop.context)
    assert made["plain"].views.count == 0 and made["plain"].views.tilt == base.views.tilt


@pytest.mark.parametrize(("changes", "words"), [({"widht": 8}, "widht"), ({"width": 0}, "width")])
def test_impossible_variants_are_named(changes: dict, words: str) -> None:
    with pytest.raises(ConfigError, match=f"variant 'odd'.*{words}"):
        variant_settings(ablation(odd=changes))


def test_the_name_of_the_unchanged_variant_is_taken() -> None:
    with pytest.raises(ValueError, match="another name"):
        ablation(**{BASE: {}})


def test_every_variant_is_trained_once_and_listed(toys: Toys, tmp_path: Path) -> None:
    torch.set_num_threads(1)
    loaded: list[Views] = []

    def load(views: Views) -> Corpus:
        loaded.append(views)
        return Corpus(tuple(toys(0, 4)), tuple(toys(500, 2)), (), load_gripper(), "p", {}, "digest")

    chosen = ablation(narrow={"width": 4}, still={"width": 4, "views": {"count": 0}})
    rows = list(run_ablation(chosen, load, tmp_path, progress=False))
    assert [row.variant for row in rows] == [BASE, "narrow", "still"] and len(loaded) == 2
    assert rows[0].parameters > rows[1].parameters == rows[2].parameters
    assert all(0 <= row.metrics["ap"] <= 1 and row.seconds > 0 for row in rows)
    lines = (tmp_path / "ablation.csv").read_text().splitlines()
    assert lines[0].startswith("variant,parameters,seconds,accuracy,ap") and len(lines) == 4
    again = list(run_ablation(chosen, load, tmp_path, progress=False))  # finished runs are not trained again
    assert [row.metrics for row in again] == [row.metrics for row in rows]
    assert [row.seconds for row in again] == [row.seconds for row in rows]
