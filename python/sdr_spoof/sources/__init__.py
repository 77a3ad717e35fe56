"""Recordings: one file and one line in ``READERS`` per format."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from sdr_spoof.errors import ConfigError
from sdr_spoof.validation import Location, in_file, validated

from . import raw, sigmf_file
from .float_level import scaled
from .model import RecordingFormat
from .reader import Description, Reader
from .recording import Recording, check_file

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = ["READERS", "Description", "Reader", "Recording", "RecordingFormat", "open_recording"]

READERS: tuple[Reader, ...] = (sigmf_file.READER, raw.SIDECAR, raw.RAW)
"""Known source formats; the first that matches a path reads it."""


def open_recording(
    path: Path | str, format: RecordingFormat | Mapping[str, Any] | None = None
) -> Recording:
    """Open a recording: ``.sigmf-meta``, ``.sigmf-data``, a TOML sidecar, or a raw file.

    Float samples are rounded to 16 bits by the receiver; without ``float_scale`` it is chosen
    from the level at the start of the file, and stands in the recording's ``format``.

    Args:
        path: the file.
        format: the whole format, or only the fields to use instead of what the file says.

    Raises:
        RecordingError: missing, a directory, empty, cut off, or unreadable metadata; float
            samples that are silent, or that ``float_scale`` makes too small or too large.
        ConfigError: the format is not known completely, or has a wrong value.
    """
    path = Path(path)
    check_file(path)
    description = next(r for r in READERS if r.matches(path)).describe(path)
    if isinstance(format, RecordingFormat):
        format = format.model_dump(exclude_unset=True)
    given = dict(format or {})
    values = {**description.values, **given}
    missing = [n for n, f in RecordingFormat.model_fields.items() if f.is_required()]
    missing = [name for name in missing if name not in values]
    if missing and set(values) <= set(RecordingFormat.model_fields):
        raise ConfigError(
            f"{description.origin}: {', '.join(missing)} not known; {description.hint}"
        )
    model = validated(RecordingFormat, values, _origin(description, given))
    return scaled(Recording(description.data, model, description.extra, description.start))


def _origin(description: Description, given: dict[str, Any]) -> Callable[[Location], str]:
    """Where a value came from: the caller's format (a flag) or the file."""
    from_file = in_file(description.origin, description.table)

    def where(location: Location) -> str:
        if location and location[0] in given:
            return f"--{str(location[0]).replace('_', '-')}"
        return from_file(location)

    return where
