"""The ship-borne tightly coupled filter with exclusion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.reproduce.study import Effort, Section, Study

from . import (
    attack_section,
    clean_section,
    coasting_section,
    errata,
    literal_section,
    statistic_section,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.progress import Stages


def sections(effort: Effort, stages: Stages) -> Sequence[Section]:
    """Every part, from the statistic to the whole."""
    parts = [
        statistic_section.section,
        literal_section.section,
        coasting_section.section,
        clean_section.section,
        attack_section.section,
    ]
    if not effort.quick:
        parts.append(attack_section.floor_section)
    return [part(effort, stages) for part in parts]


STUDY = Study(
    name="ship",
    title="Spoofing seen and left out by a ship's tightly coupled GNSS/INS",
    source="Identification and filtering of spoofing signals for a ship-borne positioning "
    "terminal: normalised accumulations of GNSS against INS, 11-state tightly coupled filter.",
    errata=errata.errata,
    sections=sections,
    full_runs=100,
    quick_runs=10,
    seeded=True,
)
