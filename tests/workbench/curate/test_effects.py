import dataclasses
import inspect

from workbench.actions import Effect
from workbench.curate import effects
from workbench.curate.desk import _WORK, Desk
from workbench.curate.view import Curation


def test_every_effect_has_somebody_who_does_it():
    kinds = {kind for _, kind in inspect.getmembers(effects, inspect.isclass) if kind.__module__ == effects.__name__}
    assert all(issubclass(kind, Effect) and dataclasses.is_dataclass(kind) for kind in kinds)
    source = inspect.getsource(Curation.perform) + inspect.getsource(Desk.perform)
    assert {kind.__name__ for kind in kinds - set(_WORK)} == {
        name for name in ("TryMore", "PlayAttempt", "ScoreMore", "StopRelabel") if f"e.{name}" in source
    }
