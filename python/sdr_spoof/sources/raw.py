"""Raw sample files; the format comes from the caller or from a TOML sidecar ``<file>.toml``.

The sidecar holds one table with the fields of RecordingFormat, and optionally ``file``, the
name of the data file where it is not the sidecar's own name without ``.toml``::

    [recording]
    sample_format = "ri8"
    sample_rate_hz = 120e6
    lo_hz = 1538.259e6
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.errors import ConfigError
from sdr_spoof.validation import load_toml, unknown_key

from .reader import Description, Reader

if TYPE_CHECKING:
    from pathlib import Path

_HINT = (
    "give --sample-format, --sample-rate-hz and --lo-hz, or write them into the [recording] table "
    "of {sidecar}"
)


def describe(path: Path) -> Description:
    """Describe a raw file from its sidecar, if it has one.

    Raises:
        ConfigError: the sidecar is not TOML or lacks the [recording] table.
    """
    sidecar = path.with_name(path.name + ".toml")
    hint = _HINT.format(sidecar=sidecar.name)
    if not sidecar.is_file():
        return Description(path, str(path), {}, hint=hint)
    return describe_sidecar(sidecar)


def describe_sidecar(sidecar: Path) -> Description:
    """Describe the raw file that belongs to a TOML sidecar.

    Raises:
        ConfigError: the sidecar is missing, not TOML, or lacks the [recording] table.
    """
    document = load_toml(sidecar)
    for key in document:
        if key != "recording":
            raise ConfigError(f"{sidecar}: {unknown_key(key, ['recording'])}")
    values = document.get("recording")
    if not isinstance(values, dict):
        raise ConfigError(f"{sidecar}: no [recording] table; it must hold the recording's format")
    values = dict(values)
    name = values.pop("file", sidecar.name.removesuffix(".toml"))
    if not isinstance(name, str):
        raise ConfigError(f"{sidecar}: [recording] file: must be a file name, not {name!r}")
    hint = _HINT.format(sidecar=sidecar.name)
    return Description(sidecar.parent / name, str(sidecar), values, "recording", hint)


SIDECAR = Reader("TOML sidecar", lambda path: path.suffix == ".toml", describe_sidecar)
RAW = Reader("raw", lambda path: True, describe)
