"""From a campaign's axes to its points and runs, each with a seed of its own.

**Seeds.** The seed of a run is a hash of the campaign's seed, the values that the axes have at its
point, and the run's number. It does not depend on the point's number: an axis that gets further
values, or others in another order, leaves the runs at the old values as they were; so does a
greater number of runs. Runs of different points are independent.
"""

from __future__ import annotations

import copy
import hashlib
import itertools
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sdr_spoof import decision, detectors
from sdr_spoof.config import Config
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.errors import ConfigError
from sdr_spoof.scenario import Scenario
from sdr_spoof.tracking import TrackingConfig
from sdr_spoof.validation import in_file, validated

from .keys import put

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from .spec import CampaignSpec, Sweep


@dataclass(frozen=True)
class Point:
    """One combination of the axes' values, with everything that a run there needs."""

    index: int
    values: tuple[tuple[str, float | str], ...]
    """Column and value of each axis, as the results show them."""
    identity: str
    """The values themselves as JSON: what seeds depend on."""
    level: str
    scenario: Scenario
    tracking: TrackingConfig
    detection: DetectionConfig


@dataclass(frozen=True)
class Job:
    """One run: what is sent to a worker."""

    point: Point
    run: int
    seed: int


def points(spec: CampaignSpec, path: Path | str = "campaign") -> list[Point]:
    """Every point of a campaign, in order: the last axis varies fastest.

    Raises:
        ConfigError: a value does not fit its key; the message names point, table and key.
    """
    return [_point(spec, index, chosen, path) for index, chosen in enumerate(_combinations(spec))]


def jobs(spec: CampaignSpec, at: list[Point]) -> Iterator[Job]:
    """Every run of a campaign: all points once, then again, so that early results cover all."""
    for run in range(spec.campaign.runs):
        for point in at:
            yield Job(point, run, seed_of(spec.campaign.seed, point.identity, run))


def seed_of(campaign_seed: int, identity: str, run: int) -> int:
    """Seed of a run, 63 bits; see the module."""
    names = repr(("campaign", campaign_seed, identity, run))
    digest = hashlib.blake2b(names.encode(), digest_size=8).digest()
    return int.from_bytes(digest, "little") >> 1


_Choice = tuple["Sweep", int]
"""An axis and the number of one of its values."""


def _combinations(spec: CampaignSpec) -> Iterator[list[_Choice]]:
    """Product of the groups; an axis without a group is a group of its own."""
    groups: dict[str, list[Sweep]] = {}
    for number, axis in enumerate(spec.sweep):
        groups.setdefault(f"g{axis.group}" if axis.group else f"a{number}", []).append(axis)
    sizes = [range(len(axes[0].points())) for axes in groups.values()]
    for numbers in itertools.product(*sizes):
        chosen = zip(groups.values(), numbers, strict=True)
        yield [(axis, number) for axes, number in chosen for axis in axes]


def _point(spec: CampaignSpec, index: int, chosen: list[_Choice], path: Path | str) -> Point:
    raw: dict[str, Any] = {
        "scenario": copy.deepcopy(spec.scenario),
        "tracking": dict(spec.tracking),
        "detection": dict(spec.detection),
    }
    # The longest keys last: what is set inside a table must come after the table.
    for axis, number in sorted(chosen, key=lambda choice: choice[0].key.count(".")):
        try:
            put(raw, axis.key, axis.points()[number])
        except ValueError as error:
            raise ConfigError(f"{path}: [[sweep]] key: {error}") from error
    identity = {axis.key: axis.points()[number] for axis, number in chosen}
    values = tuple((axis.column, axis.label(number)) for axis, number in chosen)
    where = f"{path}" + "".join(f", {column} = {value}" for column, value in values)
    scenario = validated(Scenario, raw.pop("scenario"), in_file(where, "scenario"))
    config = validated(Config, raw, in_file(where))
    _check(scenario, config.detection, where)
    return Point(
        index=index,
        values=values,
        identity=json.dumps(identity, sort_keys=True),
        level=spec.campaign.level,
        scenario=scenario,
        tracking=config.tracking,
        detection=config.detection,
    )


def _check(scenario: Scenario, detection: DetectionConfig, where: str) -> None:
    """What the models do not check themselves."""
    if not scenario.satellites:
        raise ConfigError(f"{where}: the scenario has no [[satellite]]; there is nothing to judge")
    try:
        decision.find(detection.rule)
        for name in detection.detectors:
            detectors.find(name)
    except ConfigError as error:
        raise ConfigError(f"{where}: [detection] {error}") from error
