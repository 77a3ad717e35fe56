"""A report of one page: verdict first, then evidence, then how it was made; one offline file."""

from __future__ import annotations

import base64
import platform
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING

from sdr_spoof.errors import OutputError
from sdr_spoof.sinks.atomic import replacing

from .html import LIBRARIES, flatten, template

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path


@dataclass(frozen=True)
class Row:
    """Cells of a line; the level ('spoofed', 'suspect', ...) colours the one of the verdict."""

    cells: tuple[str, ...]
    level: str = ""


@dataclass(frozen=True)
class Table:
    """Columns in words; numbers stand to the right."""

    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    left: tuple[str, ...] = ()
    """Columns that hold words."""
    verdict: str = ""
    """The column that is coloured."""


@dataclass(frozen=True)
class Part:
    """A heading with what stands below it."""

    title: str
    note: str = ""
    figures: tuple[tuple[str, bytes], ...] = ()
    """What each shows, for those who cannot see it, and the PNG."""
    table: Table | None = None
    lines: tuple[str, ...] = ()


@dataclass(frozen=True)
class Page:
    """What a report says."""

    subject: str
    """What was judged, by its name."""
    by: str
    """With what, after the subject."""
    span: str
    level: str
    """'spoofed', 'suspect', 'clean' or 'unsupported', for colours."""
    headline: str
    sentences: tuple[str, ...]
    """Who, and since when."""
    facts: tuple[tuple[str, str], ...]
    """(short question, answer)."""
    notes: tuple[str, ...]
    """What could not be tested."""
    parts: tuple[Part, ...]
    times: str
    """What times count from."""


def write_page(
    path: Path, page: Page, config: Mapping[str, object], *, force: bool = False
) -> Path:
    """Write the report; the same input gives the same bytes.

    Args:
        path: of the file.
        page: what it says.
        config: effective configuration, nested.
        force: replace a file that exists.

    Raises:
        OutputError: it exists and ``force`` is not set, or it cannot be written.
    """
    if path.exists() and not force:
        raise OutputError(f"{path}: exists already; add --force to replace it")
    content = template("page.html.j2").stream(
        page=page,
        uri=_uri,
        config=list(flatten(config)),
        versions=[(name, version(name)) for name in LIBRARIES]
        + [("Python", platform.python_version())],
    )
    with replacing(path, force=force) as temporary:
        content.dump(str(temporary), encoding="utf-8")
    return path


def listed(names: Sequence[str]) -> str:
    """Names as people write them: A, B and C."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _uri(png: bytes) -> str:
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")
