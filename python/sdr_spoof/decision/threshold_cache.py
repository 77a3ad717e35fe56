"""Thresholds that were simulated before: a table that comes along, and the user's cache folder.

What is kept is what would be simulated again; a folder that cannot be written is no error.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib import resources
from pathlib import Path

VERSION = 2
"""Of the simulation: another one gives other thresholds."""
FOLDER_VARIABLE = "SDR_SPOOF_CACHE"

_here: dict[str, list[float]] = {}


def remembered(key: str, simulate: Callable[[], list[float]]) -> list[float]:
    """The thresholds of that key, simulated where they are not known."""
    if key not in _here:
        known = shipped().get(key)
        _here[key] = _from_folder(key, simulate) if known is None else known
    return _here[key]


@cache
def shipped() -> dict[str, list[float]]:
    """The table that comes along."""
    file = resources.files("sdr_spoof.decision") / "data" / "thresholds.json"
    table = json.loads(file.read_text())
    return dict(table["thresholds"]) if table["version"] == VERSION else {}


def folder() -> Path:
    """Where thresholds are kept: $SDR_SPOOF_CACHE, or sdr-spoof in the user's cache folder."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "sdr-spoof"


def _from_folder(key: str, simulate: Callable[[], list[float]]) -> list[float]:
    name = hashlib.sha256(f"{VERSION} {key}".encode()).hexdigest()[:24]
    path = folder() / "thresholds" / f"{name}.json"
    try:
        kept = json.loads(path.read_text())
        if kept["key"] == key:
            return [float(v) for v in kept["thresholds"]]
    except (OSError, ValueError, KeyError, TypeError):
        pass
    thresholds = simulate()
    _keep(path, json.dumps({"key": key, "thresholds": thresholds}))
    return thresholds


def _keep(path: Path, text: str) -> None:
    """Written aside and moved, so that no other process reads half of it."""
    aside = path.with_suffix(f".{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        aside.write_text(text)
        aside.replace(path)
    except OSError:
        with suppress(OSError):
            aside.unlink()
