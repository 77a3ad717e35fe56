"""Reading scenario files."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Any

from sdr_spoof.errors import ConfigError
from sdr_spoof.validation import in_file, load_toml, validated

from .model import Scenario

_DATA = Path(__file__).parent / "data"
_PATHS = ("navigation", "file")
"""Keys that hold the path of another file."""


def load_scenario(path: Path | str) -> Scenario:
    """Read and check a scenario file.

    Raises:
        ConfigError: missing, not TOML, or wrong; the message names file, table and key.
    """
    path = Path(path)
    values = _with_folder(load_toml(path), path.parent)
    return validated(Scenario, values, in_file(path))


def _with_folder(value: Any, folder: Path, key: str = "") -> Any:
    """The same tables with the paths of other files from the folder of this one."""
    if isinstance(value, dict):
        return {k: _with_folder(v, folder, k) for k, v in value.items()}
    if isinstance(value, list):
        return [_with_folder(v, folder, key) for v in value]
    return str(folder / value) if key in _PATHS and isinstance(value, str) else value


def scenario_names() -> list[str]:
    """Names of the scenarios that come with the package."""
    return sorted(p.stem for p in _DATA.glob("*.toml"))


def builtin_scenario(name: str) -> Scenario:
    """A scenario that comes with the package, such as ``demo``; see :func:`scenario_names`.

    Raises:
        ConfigError: there is none of this name.
    """
    names = scenario_names()
    if name not in names:
        near = difflib.get_close_matches(name, names, n=1)
        hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(names)}"
        raise ConfigError(f"no scenario '{name}' comes with the package; {hint}")
    return load_scenario(scenario_path(name))


def scenario_path(name: str) -> Path:
    """File of a scenario that comes with the package."""
    return _DATA / f"{name}.toml"


def find_scenario(name: Path | str) -> Scenario:
    """A scenario by the path of its file, or by name if it comes with the package.

    Raises:
        ConfigError: there is neither, or the file is wrong.
    """
    path = Path(name)
    if path.suffix or path.parent != Path() or path.is_file():
        return load_scenario(path)
    return builtin_scenario(str(name))
