"""Reading scenario files."""

from __future__ import annotations

from pathlib import Path

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


def builtin_scenario(name: str) -> Scenario:
    """A scenario that comes with the package: ``demo``, ``clean`` or ``quick``.

    Raises:
        ConfigError: there is none of this name.
    """
    return load_scenario(scenario_path(name))


def scenario_names() -> list[str]:
    """Names of the scenarios that come with the package."""
    return sorted(path.stem for path in _DATA.glob("*.toml"))


def scenario_path(name: str) -> Path:
    """File of a scenario that comes with the package."""
    return _DATA / f"{name}.toml"
