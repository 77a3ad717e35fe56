"""Reading scenario files."""

from __future__ import annotations

import difflib
from pathlib import Path

from sdr_spoof.errors import ConfigError
from sdr_spoof.validation import in_file, load_toml, validated

from .model import Scenario

_DATA = Path(__file__).parent / "data"


def load_scenario(path: Path | str) -> Scenario:
    """Read and check a scenario file.

    Raises:
        ConfigError: missing, not TOML, or wrong; the message names file, table and key.
    """
    path = Path(path)
    return validated(Scenario, load_toml(path), in_file(path))


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
