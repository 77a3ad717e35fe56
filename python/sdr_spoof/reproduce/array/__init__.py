"""The three-element-array study: does a source stand still while the vehicle moves?"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.reproduce.study import Effort, Section, Study

from . import bearing, errata, left_out, track

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.progress import Stages


def sections(effort: Effort, stages: Stages) -> Sequence[Section]:
    """Every part of the study, in the order of the publication."""
    return [part.section(effort, stages) for part in (bearing, track, left_out)]


STUDY = Study(
    name="array",
    title="Near spoofers seen by a three-element array on a moving vehicle",
    source="INS-aided spoofing detection with a three-element antenna array: time-differenced "
    "carrier-phase double difference, chi-square test.",
    errata=errata.errata,
    sections=sections,
    full_runs=100,
    quick_runs=20,
)
