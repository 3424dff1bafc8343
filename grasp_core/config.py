"""The YAML loader: settings files become frozen msgspec structs, or an error that names file and key.

Every package owns its settings types (subclasses of `Settings`); this module only finds and decodes files.
"""

import hashlib
import re
import typing
from importlib import resources
from pathlib import Path
from typing import Any, TypeVar, dataclass_transform

import msgspec
import yaml

from grasp_core.errors import ConfigError, GraspError


@dataclass_transform(frozen_default=True, field_specifiers=(msgspec.field,))
class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Base of all settings: immutable, refuses unknown keys when decoded."""


S = TypeVar("S")


class _Loader(yaml.SafeLoader):
    """YAML as people write it.

    `1e-3` is a number; `on` and `yes`, dates, `1:30`, `010` and `.nan` are text, so that they are refused where a
    number belongs rather than misread; duplicate keys and merge keys (`<<`) are errors.
    """


_OWN_TAGS = {f"tag:yaml.org,2002:{name}" for name in ("float", "int", "bool", "timestamp", "merge")}
_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag not in _OWN_TAGS]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(
        r"^[-+]?(?:(?:[0-9]+\.[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|[0-9]+[eE][-+]?[0-9]+|\.inf)$", re.IGNORECASE
    ),
    list("-+0123456789."),
)
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:int", re.compile(r"^[-+]?(?:0|[1-9][0-9]*|0x[0-9a-fA-F]+)$"), list("-+0123456789")
)
_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(?:true|false|True|False)$"), list("tfTF"))


def _mapping(loader: _Loader, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
    seen: set[Any] = set()
    for key_node, _ in node.value:
        key = loader.construct_object(key_node, deep=True)
        if not isinstance(key, str | int | float) or key == "<<":
            raise yaml.constructor.ConstructorError(
                None, None, f"'{key}' is no key; a key must be a plain word", key_node.start_mark
            )
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
            f"no {kind} configuration is called '{name}'; choose one of: {', '.join(found)},"
            " or give a path that ends in .yaml"
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
    """Turn plain values into a settings struct; `where` (a file name) goes into the error.

    Raises:
        ConfigError: nothing there, or an unknown, missing or ill-typed key; the message names `where` and the key.
    """
    if value is None:
        raise ConfigError(f"{where}: is empty{_valid_keys(type_, '')}")
    try:
        return msgspec.convert(value, type_)
    except (msgspec.ValidationError, GraspError) as error:
        raise ConfigError(f"{where}: {error}{_valid_keys(type_, str(error))}") from error


def _valid_keys(type_: Any, message: str) -> str:
    """The keys that are valid at the place (`$.finger.x`) which a message of msgspec names, as a further clause."""
    found = re.search(r"`\$\.?([^`]*)`", message)
    inside, path = type_, found.group(1).split(".") if found else []
    for key in path:
        hint = typing.get_type_hints(inside).get(key)
        structs = [t for t in (hint, *typing.get_args(hint)) if isinstance(t, type) and issubclass(t, msgspec.Struct)]
        if not structs:
            break
        inside = structs[0]
    fields = ", ".join(getattr(inside, "__struct_fields__", ()))
    return f"; the keys there are: {fields}" if fields else ""


def digest(settings: msgspec.Struct) -> str:
    """A short hash of a settings value: equal settings have equal digests on every machine."""
    same_types = msgspec.convert(msgspec.to_builtins(settings), type(settings))  # 20 and 20.0 are one value
    return hashlib.sha256(msgspec.json.encode(same_types, order="sorted")).hexdigest()[:12]
