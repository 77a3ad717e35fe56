"""What a campaign file says, checked: how many runs of what, along which axes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from sdr_spoof.errors import ConfigError
from sdr_spoof.scenario.load import scenario_names, scenario_path
from sdr_spoof.validation import in_file, load_toml, validated

_CONFIG = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

ROOTS = ("scenario", "tracking", "detection")
"""Where the key of an axis may begin."""

Span = Annotated[tuple[float, float, int], Field()]
"""First value, last value, number of values."""

_TAKEN = ("point", "run", "seed", "error", "what", "hostile", "detector", "from")
"""Columns of tables that no axis may have."""

Level = Literal["correlator", "if"]


class CampaignPlan(BaseModel):
    """Table ``[campaign]``."""

    model_config = _CONFIG

    title: str = Field("", description="what it shows")
    runs: int = Field(gt=0, description="runs at each point of the sweep")
    seed: int = Field(1, ge=0, lt=2**63, description="from which every run's own seed follows")
    level: Level = Field(
        "correlator",
        description="correlator: tap outputs generated directly; if: samples made and received",
    )


class Sweep(BaseModel):
    """One axis: one ``[[sweep]]``. Axes combine as a product; those of one group go in step."""

    model_config = _CONFIG

    key: str = Field(
        description="what is varied, e.g. scenario.attack.0.drag_rate_m_s, "
        "scenario.satellite.*.cn0_dbhz (* is every element) or tracking.pll_bandwidth_hz"
    )
    values: tuple[Any, ...] | None = Field(None, description="the values themselves")
    linspace: Span | None = Field(None, description="first, last and number of even steps")
    logspace: Span | None = Field(None, description="first, last and number of equal ratios")
    name: str | None = Field(None, description="column in the results (default: the key's end)")
    labels: tuple[str, ...] | None = Field(
        None, description="a name for each value, needed where values are tables or lists"
    )
    group: str | None = Field(None, description="axes of the same group are varied in step")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        root = self.key.split(".")[0]
        if root not in ROOTS or (self.key == root and root != "scenario"):
            raise ValueError(
                f"key '{self.key}' must begin with scenario, tracking. or detection., "
                "as scenario.attack.0.drag_rate_m_s"
            )
        ways = [n for n in ("values", "linspace", "logspace") if getattr(self, n) is not None]
        if len(ways) != 1:
            raise ValueError(f"{self.key}: give one of values, linspace and logspace")
        self._check_points()
        return self

    def _check_points(self) -> None:
        span = self.linspace or self.logspace
        if span and span[2] < 1:
            raise ValueError(f"{self.key}: the number of values must be 1 or more, not {span[2]}")
        if self.logspace and min(self.logspace[:2]) <= 0:
            raise ValueError(f"{self.key}: logspace needs positive ends")
        points = self.points()
        if not points:
            raise ValueError(f"{self.key}: values is empty")
        twice = [p for number, p in enumerate(points) if p in points[:number]]
        if twice:
            raise ValueError(f"{self.key}: the value {twice[0]!r} appears twice")
        if self.labels is None and any(isinstance(p, dict | list) for p in points):
            raise ValueError(f"{self.key}: values that are tables or lists need labels")
        if self.labels is not None and len(set(self.labels)) != len(points):
            raise ValueError(f"{self.key}: labels must name each of the {len(points)} values once")

    @property
    def column(self) -> str:
        """Name of its column in the results."""
        return self.name or next(p for p in reversed(self.key.split(".")) if _is_name(p))

    def points(self) -> list[Any]:
        """Its values, in order."""
        if self.linspace:
            return [float(v) for v in np.linspace(*self.linspace)]
        if self.logspace:
            return [float(v) for v in np.geomspace(*self.logspace)]
        return list(self.values or ())

    def label(self, number: int) -> float | str:
        """How the results show the value of this number."""
        if self.labels is not None:
            return self.labels[number]
        value = self.points()[number]
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        return float(value) if is_number else str(value)


class OutputPlan(BaseModel):
    """Table ``[output]``."""

    model_config = _CONFIG

    columns: tuple[str, ...] = Field(
        ("*",),
        min_length=1,
        description="columns to keep, as patterns: C27.*, *.alarm_s; sweep values, seed, error "
        "and the truth are always kept",
    )
    within_s: float = Field(
        2.0, gt=0.0, description="an alarm within this time of a start is in time, in latency.csv"
    )


class CampaignSpec(BaseModel):
    """A whole campaign file, scenario read."""

    model_config = _CONFIG

    campaign: CampaignPlan
    scenario: dict[str, Any] = Field(description="as in a scenario file, before any sweep")
    tracking: dict[str, Any] = Field(default_factory=dict, description="as in a configuration")
    detection: dict[str, Any] = Field(default_factory=dict, description="as in a configuration")
    sweep: tuple[Sweep, ...] = Field((), description="axes")
    output: OutputPlan = Field(default_factory=OutputPlan, description="what is kept")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        names = [axis.column for axis in self.sweep]
        twice = next((n for n in names if names.count(n) > 1), None)
        if twice is not None:
            raise ValueError(f"two [[sweep]] have the column '{twice}'; give one of them a name")
        taken = next((n for n in names if n in _TAKEN), None)
        if taken is not None:
            raise ValueError(f"[[sweep]]: the column '{taken}' is taken; give the axis a name")
        for group in {a.group for a in self.sweep if a.group is not None}:
            sizes = {a.column: len(a.points()) for a in self.sweep if a.group == group}
            if len(set(sizes.values())) > 1:
                told = ", ".join(f"{name} has {size}" for name, size in sizes.items())
                raise ValueError(f"[[sweep]] of group '{group}' need equally many values: {told}")
        return self


def load_spec(path: Path | str) -> CampaignSpec:
    """Read and check a campaign file and the scenario that it names.

    ``scenario`` is a table as in a scenario file, a built-in name, or a path beside the file.

    Raises:
        ConfigError: missing, not TOML, or wrong; the message names file, table and key.
    """
    path = Path(path)
    values = load_toml(path)
    values["scenario"] = _scenario(path, values.get("scenario"))
    for axis in values.get("sweep", ()):
        if isinstance(axis, dict) and axis.get("key") == "scenario":
            _name_scenarios(path, axis)
    return validated(CampaignSpec, values, in_file(path))


def _name_scenarios(path: Path, axis: dict[str, Any]) -> None:
    """Read the scenarios that an axis names."""
    named = axis.get("values", ())
    if not isinstance(named, list):
        return
    axis.setdefault("labels", [v for v in named if isinstance(v, str)])
    axis["values"] = [_scenario(path, v) for v in named]


def _scenario(path: Path, given: Any) -> dict[str, Any]:
    """The raw values of the scenario that a campaign file gives or names."""
    if isinstance(given, dict):
        return given
    if given is None:
        raise ConfigError(
            f"{path}: scenario: missing; name a file or a built-in scenario "
            f"({', '.join(scenario_names())}) above the first table, or add a table [scenario]"
        )
    if given in scenario_names():
        return load_toml(scenario_path(given))
    beside = path.parent / str(given)
    if not beside.is_file():
        raise ConfigError(
            f"{path}: scenario: '{given}' is neither a file ({beside}) nor a built-in scenario; "
            f"built-in are {', '.join(scenario_names())}"
        )
    return load_toml(beside)


def _is_name(part: str) -> bool:
    return part != "*" and not part.isdecimal()
