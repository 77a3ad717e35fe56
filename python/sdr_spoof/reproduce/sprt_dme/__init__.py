"""The INS/DME study: sequential tests of pseudoranges against an INS, with DME beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.reproduce.study import Effort, Section, Study

from . import (
    comparison_section,
    delay_section,
    dme_section,
    errata,
    isolation_section,
    laws_section,
    satellites_section,
    variance_section,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.progress import Stages

PARTS = (
    variance_section,
    delay_section,
    satellites_section,
    comparison_section,
    dme_section,
    isolation_section,
    laws_section,
)


def sections(effort: Effort, stages: Stages) -> Sequence[Section]:
    """Every part of the study."""
    return [part.section(effort, stages) for part in PARTS]


STUDY = Study(
    name="sprt-dme",
    title="Sequential tests of GNSS against INS and DME",
    source="An improved sequential probability ratio test for airborne GNSS spoofing detection "
    "with INS and DME: fitted pseudorange differences, compensation by Bayes risk.",
    errata=errata.errata,
    sections=sections,
    full_runs=2000,
    quick_runs=60,
)
