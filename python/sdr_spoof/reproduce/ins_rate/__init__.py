"""The INS-aided pseudorange-rate consistency study: a free INS against carrier phase."""

from __future__ import annotations

from collections.abc import Sequence

from sdr_spoof.progress import Stages
from sdr_spoof.reproduce.parallel import workers
from sdr_spoof.reproduce.study import Effort, Section, Study

from . import (
    drag_section,
    drift_section,
    errata,
    false_alarms,
    flight_section,
    rules_section,
    tests_section,
)


def sections(effort: Effort, stages: Stages) -> Sequence[Section]:
    """Every part of the study."""
    with workers(effort.threads) as executor:
        drift = drift_section.section(effort, stages, executor)
        drags = drag_section.section(effort, stages, executor)
        rules = rules_section.section(effort, stages, executor)
    found = [part.section(effort, stages) for part in (false_alarms, flight_section, tests_section)]
    return [drift, *found, rules, drags]


STUDY = Study(
    name="ins-rate",
    title="Pseudorange-rate consistency with an INS",
    source="Chang et al., An INS-assisted BDS pseudorange rate consistency deception signal "
    "detection method, Journal of Air Force Engineering University 23 (4), 2022.",
    errata=errata.errata,
    sections=sections,
    full_runs=100,
    quick_runs=10,
)
