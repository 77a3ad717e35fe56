"""The folder of a campaign's results, and whether a campaign may go on in it.

``campaign.toml`` is the file as it was given, ``campaign.json`` what it was taken to mean,
scenario included; ``runs.jsonl`` the runs as they ended, ``runs.h5`` the table of them.
"""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from sdr_spoof.errors import ConfigError, OutputError
from sdr_spoof.sinks.atomic import write_bytes

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from .columns import Column
    from .spec import CampaignSpec


@dataclass(frozen=True)
class Folder:
    """Where the parts of the results lie."""

    path: Path

    @property
    def given(self) -> Path:
        """Copy of the campaign file."""
        return self.path / "campaign.toml"

    @property
    def meaning(self) -> Path:
        """What the campaign file was taken to mean."""
        return self.path / "campaign.json"

    @property
    def journal(self) -> Path:
        """Runs as they ended."""
        return self.path / "runs.jsonl"

    @property
    def table(self) -> Path:
        """Runs in order."""
        return self.path / "runs.h5"


def meaning_of(spec: CampaignSpec, columns: Sequence[Column]) -> dict[str, Any]:
    """Everything that the results depend on."""
    meaning = {
        "version": version("sdr-spoof"),
        **spec.model_dump(mode="json"),
        "columns": [[c.name, c.kind] for c in columns],
    }
    plain: dict[str, Any] = json.loads(json.dumps(meaning))  # tuples as lists, as if read again
    return plain


def prepare(folder: Folder, spec_file: Path, meaning: dict[str, Any], *, force: bool) -> None:
    """Make the folder for a new campaign, or find that the same campaign was begun in it.

    Raises:
        ConfigError: another campaign was begun in it.
        OutputError: it is no folder, holds other things, or cannot be written.
    """
    if folder.path.exists() and not folder.path.is_dir():
        raise OutputError(f"{folder.path}: is a file; name a folder")
    if folder.meaning.exists() and not force:
        _compare(folder, meaning)
        return
    if folder.journal.exists() and not force:
        raise OutputError(f"{folder.journal}: exists already; name another folder or add --force")
    try:
        folder.path.mkdir(parents=True, exist_ok=True)
        folder.journal.unlink(missing_ok=True)
        folder.table.unlink(missing_ok=True)
        shutil.copyfile(spec_file, folder.given)
    except OSError as error:
        raise OutputError(f"{folder.path}: cannot be written: {error.strerror}") from error
    text = json.dumps(meaning, indent=1) + "\n"
    write_bytes(folder.meaning, text.encode(), force=True)


def _compare(folder: Folder, meaning: dict[str, Any]) -> None:
    try:
        before = json.loads(folder.meaning.read_text(encoding="utf-8"))
    except ValueError as error:
        raise OutputError(
            f"{folder.meaning}: damaged; name another folder or add --force"
        ) from error
    changed = [name for name in meaning if before.get(name) != meaning[name]]
    if changed:
        raise ConfigError(
            f"{folder.path}: holds another campaign, with another {', '.join(changed)}; it "
            "cannot go on with this file: name another folder, or add --force to start anew"
        )
