"""A shipped planner with some of its settings changed."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from grasp_core import config
from grasp_core.errors import ConfigError
from grasp_core.gripper import Gripper
from grasp_core.networks.runtime import Runtime
from grasp_core.planning.planner import PLANNERS, Planner


def needs_networks(name: str | Path) -> bool:
    """Whether planners of this name run the networks.

    Raises:
        ConfigError: no such planner.
    """
    return _read(name)[0] in ("cascade", "exhaustive")


def make_variant(
    name: str | Path,
    changes: Mapping[str, Any],
    *,
    gripper: Gripper,
    weights: str | Path = "default",
    runtime: Runtime | None = None,
) -> Planner:
    """A planner by name with other settings; those that this kind of planner does not have are left out.

    Args:
        name: of a shipped planner, or a .yaml file.
        changes: name of a setting → its value.
        gripper: that grasps.
        weights: shipped name or path; for planners with networks.
        runtime: networks that are loaded already; takes the place of `weights`.

    Raises:
        ConfigError: no such planner, or a value that the setting cannot have.
        MismatchError: the weights are for another gripper.
    """
    kind, values = _read(name)
    module, class_ = PLANNERS[kind]
    maker: Any = getattr(importlib.import_module(module), class_)
    known = msgspec.structs.fields(maker.settings_type)
    values.update({field.name: changes[field.name] for field in known if field.name in changes})
    settings = config.convert(values, maker.settings_type, str(name))
    planner: Planner = maker.make(settings, gripper, weights=weights, runtime=runtime)
    return planner


def _read(name: str | Path) -> tuple[str, dict[str, Any]]:
    """Kind and settings of a planner file."""
    path = config.locate("planners", name)
    values = config.read_yaml(path)
    kind = values.pop("planner", None) if isinstance(values, dict) else None
    if kind not in PLANNERS:
        raise ConfigError(f"{path}: planner: must be one of: {', '.join(PLANNERS)}, not {kind!r}")
    return kind, values
