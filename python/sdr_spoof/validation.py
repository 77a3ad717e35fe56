"""From files and pydantic errors to messages that a user can act on."""

from __future__ import annotations

import difflib
import tomllib
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import BaseModel, ValidationError

from .errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from pydantic_core import ErrorDetails

Model = TypeVar("Model", bound=BaseModel)

Location = tuple[str | int, ...]
"""Path of a value in a nested model, as pydantic reports it."""


def load_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file.

    Raises:
        ConfigError: if it is missing, not readable, or not TOML (with line and column).
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: not valid TOML: {error}") from error


def validated(
    model: type[Model],
    values: Mapping[str, Any],
    where: Callable[[Location], str],
) -> Model:
    """Build a model; ``where`` names the origin of a value (file and key, or flag) in messages.

    Raises:
        ConfigError: one line for each wrong value; a misspelt key gets the nearest valid one.
    """
    try:
        return model.model_validate(values)
    except ValidationError as error:
        lines = [
            f"{where(_walk(model, e['loc'])[1])}: {_message(e, model)}" for e in error.errors()
        ]
        raise ConfigError("\n".join(lines)) from error


def in_file(path: Path | str, table: str | None = None) -> Callable[[Location], str]:
    """Origin of the values of one file, for :func:`validated`: ``file: [table] key``."""

    def where(location: Location) -> str:
        *tables, key = [*([table] if table else []), *location] or [""]
        if isinstance(key, int):  # an element of a list, as in [[satellite]]: the table is wrong
            return f"{path}: {_table_name([*tables, key])}"
        return " ".join(filter(None, (f"{path}:", _table_name(tables), key))).removesuffix(":")

    return where


def _table_name(steps: Sequence[str | int]) -> str:
    """``[a.b]`` of nested tables; ``[[a]] (number 2)`` of the second element of a list."""
    if not steps:
        return ""
    if isinstance(steps[-1], int):
        names = ".".join(str(s) for s in steps[:-1])
        return f"[[{names}]] (number {steps[-1] + 1})"
    return f"[{'.'.join(str(s) for s in steps)}]"


def _message(error: ErrorDetails, model: type[BaseModel]) -> str:
    if error["type"] == "extra_forbidden":
        *tables, key = error["loc"]
        return unknown_key(str(key), _fields_at(model, tuple(tables)))
    if error["type"] == "union_tag_invalid":
        tag, known = error["ctx"]["tag"], error["ctx"]["expected_tags"]
        return f"unknown kind '{tag}'; known kinds: {known}"
    if error["type"] == "missing":
        return "missing; this value is required"
    if error["type"] == "value_error":
        return str(error["ctx"]["error"])
    return f"{error['msg']}, not {error['input']!r}"


def unknown_key(key: str, known: list[str]) -> str:
    """Message for a key that does not exist, with the nearest existing one."""
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.4)
    if near:
        return f"unknown key '{key}'; did you mean '{near[0]}'?"
    return f"unknown key '{key}'; known keys: {', '.join(known)}"


def _fields_at(model: type[BaseModel], location: Location) -> list[str]:
    """Field names of the model found by walking down ``location``."""
    current, _ = _walk(model, location)
    return [] if current is None else sorted(current.model_fields)


def _walk(model: type[BaseModel], location: Location) -> tuple[type[BaseModel] | None, Location]:
    """The model at the end of a location, and the location without the tags of unions.

    pydantic names the member of a union by its tag, its ``kind``, which no file holds as a table.
    """
    current: type[BaseModel] | None = model
    members: dict[Any, type[BaseModel]] = {}
    plain: list[str | int] = []
    for step in location:
        if step in members:
            current, members = members[step], {}
            continue
        plain.append(step)
        field = current.model_fields.get(step) if current and isinstance(step, str) else None
        if field is not None:
            inner = _inner_models(field.annotation)
            current = inner[0] if inner else None
            members = {m.model_fields["kind"].default: m for m in inner} if len(inner) > 1 else {}
    return current, tuple(plain)


def _inner_models(annotation: Any) -> list[type[BaseModel]]:
    """pydantic models inside an annotation such as ``list[Model]`` or ``Model | None``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [m for a in getattr(annotation, "__args__", ()) for m in _inner_models(a)]
