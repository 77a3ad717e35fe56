"""SigMF recordings: ``<stem>.sigmf-meta`` beside ``<stem>.sigmf-data``, through the sigmf package.

``core:frequency`` does not say where the spectrum of a *real* recording lies (its centre may be
the carrier, the middle of the band or the local oscillator), so the radio frequency at 0 Hz is
kept in our own namespace as ``sdr_spoof:lo_hz``. Files that lack it are read as follows: complex
samples take ``core:frequency`` as the frequency at 0 Hz, as SigMF means it; real samples need
lo_hz from the caller. Writing sets both, ``core:frequency`` being the middle of the held band.
SigMF has no 2-bit samples: those formats exist as raw files only.
"""

from __future__ import annotations

import json
import warnings
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sdr_spoof.errors import ConfigError, OutputError, RecordingError

from .reader import Description, Reader

if TYPE_CHECKING:
    from .model import RecordingFormat

META, DATA = ".sigmf-meta", ".sigmf-data"
_NAMESPACE = "sdr_spoof:"
_DATATYPES = {
    "ri8": "ri8",
    "ci8": "ci8",
    "ri16_le": "ri16",
    "ci16_le": "ci16",
    "rf32_le": "rf32",
    "cf32_le": "cf32",
}
_OWN_FIELDS = ("lo_hz", "conjugate", "bandwidth_hz", "float_scale", "gain_file")


def describe(path: Path) -> Description:
    """Describe a SigMF recording, named by either of its files.

    Raises:
        RecordingError: archive, metadata missing or invalid, or a datatype that is not supported.
    """
    if path.suffix == ".sigmf":
        raise RecordingError(f"{path}: SigMF archives are not read; unpack it with tar first")
    meta = path.with_suffix(META)
    header, capture = _load(meta, path)
    values: dict[str, Any] = {
        "sample_format": _sample_format(meta, header.get("core:datatype")),
        "offset_bytes": int(capture.get("core:header_bytes", 0)),
    }
    if "core:sample_rate" in header:
        values["sample_rate_hz"] = header["core:sample_rate"]
    if values["sample_format"].startswith("c") and "core:frequency" in capture:
        values["lo_hz"] = capture["core:frequency"]
    own = {k.removeprefix(_NAMESPACE): v for k, v in header.items() if k.startswith(_NAMESPACE)}
    values |= {k: own.pop(k) for k in _OWN_FIELDS if k in own}
    data = meta.with_name(header.get("core:dataset", meta.with_suffix(DATA).name))
    hint = "give the missing values as flags, e.g. --lo-hz, or add sdr_spoof:lo_hz to the metadata"
    start = _start(meta, capture.get("core:datetime"))
    return Description(data, str(meta), values, hint=hint, extra=own, start=start)


def write_meta(
    stem: Path | str,
    format: RecordingFormat,
    extra: dict[str, Any] | None = None,
    start: datetime | None = None,
) -> Path:
    """Write ``<stem>.sigmf-meta`` for samples in ``<stem>.sigmf-data``; replaces an older one.

    Args:
        stem: path without ``.sigmf-meta`` or ``.sigmf-data`` (either is removed if present).
        format: format of the samples.
        extra: more global fields, written as ``sdr_spoof:<key>``; any JSON value. ``description``
            becomes ``core:description``.
        start: UTC of the first sample, where it is known.

    Raises:
        ConfigError: a 2-bit format, which SigMF does not know.
        OutputError: the file cannot be written.
    """
    from sigmf import SigMFFile  # noqa: PLC0415 - slow to import, needed by few commands

    meta = _meta_path(Path(stem))
    file = SigMFFile(global_info=_global_fields(format, dict(extra or {})))
    capture: dict[str, Any] = {"core:frequency": sum(format.band_hz) / 2}
    if format.offset_bytes:
        capture["core:header_bytes"] = format.offset_bytes
    if start is not None:
        text = start.astimezone(UTC).isoformat(timespec="microseconds")
        capture["core:datetime"] = text.replace("+00:00", "Z")
    file.add_capture(0, metadata=capture)
    file.validate()
    try:
        meta.write_text(file.dumps(pretty=True) + "\n", encoding="utf-8")
    except OSError as error:
        raise OutputError(f"{meta}: cannot be written: {error.strerror}") from error
    return meta


def _meta_path(stem: Path) -> Path:
    name = stem.name.removesuffix(META).removesuffix(DATA)
    return stem.with_name(name + META)


def _global_fields(format: RecordingFormat, extra: dict[str, Any]) -> dict[str, Any]:
    by_format = {ours: theirs for theirs, ours in _DATATYPES.items()}
    if format.sample_format not in by_format:
        raise ConfigError(
            f"SigMF cannot hold {format.sample_format} samples; write a raw file, or use one of "
            f"{', '.join(by_format)}"
        )
    fields: dict[str, Any] = {
        "core:datatype": by_format[format.sample_format],
        "core:sample_rate": format.sample_rate_hz,
        "core:recorder": "sdr-spoof",
        "core:extensions": [{"name": "sdr_spoof", "version": "0.1.0", "optional": True}],
    }
    if "description" in extra:
        fields["core:description"] = extra.pop("description")
    own = format.model_dump(include=set(_OWN_FIELDS), exclude_none=True)
    if "float_scale" not in format.model_fields_set:
        del own["float_scale"]  # chosen on reading
    return fields | {_NAMESPACE + k: v for k, v in {**own, **extra}.items()}


def _load(meta: Path, asked: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Global fields and first capture of a metadata file."""
    from jsonschema import ValidationError  # noqa: PLC0415 - what sigmf's validation raises
    from sigmf import SigMFFile  # noqa: PLC0415
    from sigmf.error import SigMFError  # noqa: PLC0415

    if not meta.is_file():
        raise RecordingError(
            f"{asked}: its metadata {meta.name} is missing; restore it, or rename the data file "
            "and give the format as flags"
        )
    try:
        file = SigMFFile(metadata=json.loads(meta.read_text(encoding="utf-8")))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # namespaces that others forgot to declare
            file.validate()
    except OSError as error:
        raise RecordingError(f"{meta}: cannot be read: {error.strerror}") from error
    except (ValueError, TypeError, KeyError, AttributeError, SigMFError, ValidationError) as error:
        reason = str(error).splitlines()[0]
        raise RecordingError(f"{meta}: not valid SigMF metadata: {reason}") from error
    header = file.get_global_info()
    if header.get("core:num_channels", 1) != 1:
        raise RecordingError(f"{meta}: more than one channel; split the recording first")
    captures = file.get_captures()
    return header, (captures[0] if captures else {})


def _start(meta: Path, text: object) -> datetime | None:
    """UTC of the first sample; SigMF has it as ISO 8601, and as UTC where no zone is given."""
    if text is None:
        return None
    try:
        date = datetime.fromisoformat(str(text))
    except ValueError as error:
        raise RecordingError(f"{meta}: core:datetime '{text}' is not a date: {error}") from error
    return date.replace(tzinfo=UTC) if date.tzinfo is None else date.astimezone(UTC)


def _sample_format(meta: Path, datatype: object) -> str:
    known = _DATATYPES.get(str(datatype))
    if known is None:
        raise RecordingError(
            f"{meta}: datatype {datatype} is not supported; convert the recording to one of "
            f"{', '.join(_DATATYPES)}"
        )
    return known


READER = Reader("SigMF", lambda path: path.suffix in (META, DATA, ".sigmf"), describe)
