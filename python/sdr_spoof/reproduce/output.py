"""The folder of a reproduction: CSV, PNG, one self-contained HTML file, and the summary."""

from __future__ import annotations

import base64
import csv
import io
import json
import math
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from sdr_spoof.errors import OutputError
from sdr_spoof.sinks.atomic import reason, write_bytes

from .study import Cell, Number, Picture, Reproduction, Study, Table


def check_folder(folder: Path, study: Study, *, force: bool) -> None:
    """Refuse early what could not be written in the end.

    Raises:
        OutputError: the folder is a file, or holds a reproduction of the study already and
            ``force`` is not set.
    """
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is not a folder; name another with -o")
    if (folder / f"{study.name}.html").exists() and not force:
        raise OutputError(
            f"{folder}: holds a reproduction of {study.name} already; add --force to replace it"
        )


def write(made: Reproduction, folder: Path, *, force: bool = False) -> Reproduction:
    """Write every table, picture, the report and the summary; the same input, the same bytes.

    Returns the reproduction with the names of its files.

    Raises:
        OutputError: a file exists and ``force`` is not set, or cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be made: {reason(error)}") from error
    contents = dict(_contents(made))
    made = replace(made, files=sorted([*contents, f"{made.study.name}.json"]))
    contents[f"{made.study.name}.json"] = _json(summary(made))
    for name, content in contents.items():
        write_bytes(folder / name, content, force=force)
    return made


def _contents(made: Reproduction) -> Iterator[tuple[str, bytes]]:
    for section in made.sections:
        for table in section.tables:
            yield f"{table.name}.csv", csv_of(table)
        for picture in section.pictures:
            yield f"{picture.name}.png", picture.png
    yield f"{made.study.name}.html", html_of(made).encode()


def summary(made: Reproduction) -> dict[str, Any]:
    """What ``--json`` prints: every acceptance number, every table, what was left out."""
    return {
        "study": made.study.name,
        "title": made.study.title,
        "effort": {
            "runs": made.effort.runs,
            "quick": made.effort.quick,
            "seed": made.effort.seed,
        },
        "met": made.met,
        "acceptance": [{**asdict(n), "met": n.met} for n in made.numbers],
        "tables": {
            t.name: [dict(zip(t.columns, row, strict=True)) for row in t.rows]
            for s in made.sections
            for t in s.tables
            if t.shown
        },
        "errata": [asdict(e) for e in made.errata],
        "skipped": [reason for s in made.sections for reason in s.skipped],
        "files": list(made.files),
    }


def _json(data: dict[str, Any]) -> bytes:
    return (json.dumps(_finite(data), indent=1, allow_nan=False) + "\n").encode()


def _finite(value: Any) -> Any:
    """The same without NaN and infinities, which JSON cannot hold."""
    if isinstance(value, dict):
        return {key: _finite(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def csv_of(table: Table) -> bytes:
    """A table as CSV, with nothing in a cell that has no value."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(table.columns)
    writer.writerows([["" if c is None else c for c in row] for row in table.rows])
    return buffer.getvalue().encode()


def html_of(made: Reproduction) -> str:
    """The report: one file with everything inside it."""
    environment = Environment(
        loader=PackageLoader("sdr_spoof.reproduce"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    template = environment.get_template("study.html.j2")
    return template.render(made=made, cell=cell, limits=limits, uri=_uri)


def cell(value: Cell) -> str:
    """A value as people read it."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.5g}" if abs(value) < 1e5 else f"{value:.0f}"
    return str(value)


def limits(number: Number) -> str:
    """The interval of an acceptance number as people read it."""
    if math.isinf(number.high):
        return f"at least {cell(number.low)}"
    if math.isinf(number.low):
        return f"at most {cell(number.high)}"
    return f"{cell(number.low)} to {cell(number.high)}"


def _uri(picture: Picture) -> str:
    return "data:image/png;base64," + base64.b64encode(picture.png).decode("ascii")
