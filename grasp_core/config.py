"""The YAML loader: settings files become frozen msgspec structs, or an error that names file and key.

Every package owns its settings types (subclasses of `Settings`); this module only finds and decodes files.
"""

import hashlib
import re
from importlib import resources
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import yaml

from grasp_core.errors import ConfigError


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of all settings: immutable, keyword-only, refuses unknown keys when decoded."""


S = TypeVar("S")


class _Loader(yaml.SafeLoader):
    """YAML as people write it: `1e-3` is a number, `on`/`yes` are text, duplicate keys are errors."""


_Loader.yaml_implicit_resolvers = {
    first: [
        (tag, pattern) for tag, pattern in resolvers if tag not in ("tag:yaml.org,2002:float", "tag:yaml.org,2002:bool")
    ]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(
        r"^[-+]?(?:(?:[0-9]+\.[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|[0-9]+[eE][-+]?[0-9]+|\.inf|\.nan)$", re.IGNORECASE
    ),
    list("-+0123456789."),
)
_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(?:true|false|True|False)$"), list("tfTF"))


def _mapping(loader: _Loader, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
    seen: set[Any] = set()
    for key_node, _ in node.value:
        key = loader.construct_object(key_node, deep=True)
        if isinstance(key, list | dict):
            raise yaml.constructor.ConstructorError(None, None, "a key must be a plain word", key_node.start_mark)
        if key in seen:
            raise yaml.constructor.ConstructorError(None, None, f"the key '{key}' stands twice", key_node.start_mark)
        seen.add(key)
    return yaml.SafeLoader.construct_mapping(loader, node, deep=deep)


def _construct(loader: _Loader, node: yaml.MappingNode) -> dict[Any, Any]:
    return _mapping(loader, node, deep=True)


_Loader.add_constructor("tag:yaml.org,2002:map", _construct)


def shipped(kind: str) -> dict[str, Path]:
    """Name → file of every shipped configuration of one kind (a folder of `static_configs`)."""
    folder = Path(str(resources.files("static_configs"))) / kind
    return {path.stem: path for path in sorted(folder.glob("*.yaml"))}


def locate(kind: str, name: str | Path) -> Path:
    """The file of a configuration: arguments that end in `.yaml` are paths, others are shipped names.

    Raises:
        ConfigError: no such file or name; the message lists the valid names.
    """
    if str(name).endswith((".yaml", ".yml")):
        path = Path(name).expanduser()
        if not path.is_file():
            raise ConfigError(
                f"{path}: no such file; give an existing .yaml file or one of: {', '.join(shipped(kind))}"
            )
        return path
    found = shipped(kind)
    if str(name) not in found:
        raise ConfigError(
            f"no {kind} configuration is called '{name}'; choose one of: {', '.join(found)}, or give a path that ends in .yaml"
        )
    return found[str(name)]


def read_yaml(path: Path) -> Any:
    """Parse one YAML file with the rules above.

    Raises:
        ConfigError: unreadable, not YAML, or a duplicate key; the message names file and line.
    """
    try:
        with path.open("rb") as stream:
            return yaml.load(stream, Loader=_Loader)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror})") from error
    except yaml.MarkedYAMLError as error:
        line = f" line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise ConfigError(f"{path}:{line} {error.problem}; mend that line") from error
    except (yaml.YAMLError, ValueError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: is not YAML ({error})") from error


def load(kind: str, name: str | Path, type_: type[S]) -> S:
    """Decode the configuration `name` (shipped name or path) of one kind into its settings type.

    Raises:
        ConfigError: missing file, or an unknown, missing or ill-typed key; the message names file and key.
    """
    path = locate(kind, name)
    return convert(read_yaml(path), type_, str(path))


def convert(value: Any, type_: type[S], where: str) -> S:
    """Turn plain values into a settings struct; `where` (a file name) goes into the error."""
    if value is None:
        raise ConfigError(f"{where}: is empty; it must hold the keys of {type_.__name__}")
    try:
        return msgspec.convert(value, type_)
    except msgspec.ValidationError as error:
        fields = ", ".join(getattr(type_, "__struct_fields__", ()))
        raise ConfigError(f"{where}: {error}; {type_.__name__} has the keys: {fields}") from error


def digest(settings: msgspec.Struct) -> str:
    """A short hash of a settings value: equal settings have equal digests on every machine."""
    return hashlib.sha256(msgspec.json.encode(settings, order="sorted")).hexdigest()[:12]
