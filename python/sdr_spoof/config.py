"""One configuration model: TOML, command-line flags, help and errors all come from it.

Each stage's model lives in the stage's own module; here they are grouped. A field
``acquisition.pfa`` is the key ``pfa`` of the table ``[acquisition]`` in TOML and the flag
``--acquisition-pfa``. Flags win over the file, the file over the defaults.
"""

from __future__ import annotations

import typing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, Field

from .acquisition import AcquisitionConfig
from .aided.config import AidedConfig
from .aiding.array.config import ArrayConfig
from .aiding.dme.config import SequentialConfig
from .aiding.imu.config import ImuConfig
from .aiding.rate_config import RateConfig
from .aiding.tight.config import TightConfig
from .detectors import DetectionConfig
from .observables import ObservablesConfig
from .positioning.config import NavigationConfig
from .pvt.config import PvtConfig
from .tracking import TrackingConfig
from .validation import Location, in_file, load_toml, validated

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterator, Sequence

    from pydantic.fields import FieldInfo

FLAG_PREFIX = "config:"
"""Of the destinations of flags, before the dotted name of the field."""


class Config(BaseModel):
    """Every setting of every stage; the effective one is written into each result file."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    acquisition: AcquisitionConfig = Field(
        default_factory=AcquisitionConfig, description="FFT search for satellites"
    )
    tracking: TrackingConfig = Field(
        default_factory=TrackingConfig, description="code and carrier tracking loops"
    )
    detection: DetectionConfig = Field(
        default_factory=DetectionConfig, description="spoofing detectors and their thresholds"
    )
    observables: ObservablesConfig = Field(
        default_factory=ObservablesConfig,
        description="pseudorange, carrier phase and Doppler at common receiver times",
    )
    navigation: NavigationConfig = Field(
        default_factory=NavigationConfig, description="positioning, and what may help it"
    )
    pvt: PvtConfig = Field(
        default_factory=PvtConfig, description="what a position is made of, and how it is checked"
    )
    imu: ImuConfig = Field(
        default_factory=ImuConfig, description="how an IMU is mounted, and how its file is read"
    )
    rate: RateConfig = Field(
        default_factory=RateConfig, description="consistency of rates with an INS"
    )
    tight: TightConfig = Field(
        default_factory=TightConfig, description="tightly coupled filter of GNSS and INS"
    )
    sequential: SequentialConfig = Field(
        default_factory=SequentialConfig, description="sequential tests against an INS and DME"
    )
    array: ArrayConfig = Field(
        default_factory=ArrayConfig, description="directions by an array of antennas"
    )
    aided: AidedConfig = Field(
        default_factory=AidedConfig, description="aided navigation as a whole"
    )


def load_config(path: Path | str | None = None, flags: dict[str, str] | None = None) -> Config:
    """Build the configuration from a TOML file and from flag values, as given as text.

    Args:
        path: TOML file, or None.
        flags: dotted field name (``acquisition.pfa``) to text.

    Raises:
        ConfigError: file missing or not TOML; unknown key (with the nearest one); wrong value.
    """
    values = load_toml(Path(path)) if path is not None else {}
    for name, text in (flags or {}).items():
        _put(values, name.split("."), text)
    return validated(Config, values, _origin(path, flags or {}))


def add_flags(parser: argparse.ArgumentParser, groups: Sequence[str]) -> None:
    """Add ``--config FILE`` and one flag per field of the named groups, with their help."""
    common = parser.add_argument_group("configuration")
    common.add_argument("--config", metavar="FILE", type=Path, help="TOML file with settings")
    for group in groups:
        field = Config.model_fields[group]
        section = parser.add_argument_group(group, field.description)
        for name, leaf in _leaves(field, (group,)):
            section.add_argument(
                flag_name(name),
                dest=FLAG_PREFIX + ".".join(name),
                metavar=_metavar(leaf.annotation),
                help=_help(leaf),
            )


def from_arguments(arguments: argparse.Namespace) -> Config:
    """Configuration of parsed arguments (see :func:`add_flags`).

    Raises:
        ConfigError: as :func:`load_config`.
    """
    flags = {
        key.removeprefix(FLAG_PREFIX): value
        for key, value in vars(arguments).items()
        if key.startswith(FLAG_PREFIX) and value is not None
    }
    return load_config(arguments.config, flags)


def flag_name(location: Sequence[str]) -> str:
    """Flag of a field: ``("acquisition", "pfa")`` -> ``--acquisition-pfa``."""
    return "--" + "-".join(location).replace("_", "-")


def _leaves(
    field: FieldInfo, location: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], FieldInfo]]:
    """Fields below ``field`` that hold values, with their locations."""
    model = field.annotation
    if isinstance(model, type) and issubclass(model, BaseModel):
        for name, inner in model.model_fields.items():
            yield from _leaves(inner, (*location, name))
    else:
        yield location, field


def _put(values: dict[str, Any], location: Sequence[str], text: str) -> None:
    """Set a flag's text in the nested values, split at commas if the field is a sequence."""
    field = Config.model_fields[location[0]]
    for step in location[1:]:
        field = typing.cast("type[BaseModel]", field.annotation).model_fields[step]
    *tables, key = location
    for table in tables:
        values = values.setdefault(table, {})
    values[key] = [p.strip() for p in text.split(",")] if _is_sequence(field.annotation) else text


def _is_sequence(annotation: Any) -> bool:
    origins = {typing.get_origin(a) or a for a in (annotation, *typing.get_args(annotation))}
    return bool(origins & {tuple, list, frozenset})


def _metavar(annotation: Any) -> str:
    if typing.get_origin(annotation) is typing.Literal:
        return "{" + ",".join(map(str, typing.get_args(annotation))) + "}"
    if _is_sequence(annotation):
        return "A,B,..."
    if isinstance(annotation, type):
        names = {"bool": "true|false", "str": "NAME", "int": "N", "float": "X"}
        return names.get(annotation.__name__, "VALUE")
    return "VALUE"


def _help(field: FieldInfo) -> str:
    text = (field.description or "").replace("%", "%%")
    default = field.get_default(call_default_factory=True, validated_data={})
    if isinstance(default, tuple | list):
        default = ",".join("+".join(d) if isinstance(d, tuple) else str(d) for d in default)
    elif isinstance(default, bool):
        default = str(default).lower()
    if default is None:
        return text
    return f"{text.rstrip('.')} (default: {'none' if default == '' else default})"


def _origin(path: Path | str | None, flags: dict[str, str]) -> Callable[[Location], str]:
    from_file = in_file(path if path is not None else "configuration")

    def where(location: Location) -> str:
        names = [str(step) for step in location]
        for length in range(len(names), 0, -1):
            if ".".join(names[:length]) in flags:
                return flag_name(names[:length])
        return from_file(location)

    return where
