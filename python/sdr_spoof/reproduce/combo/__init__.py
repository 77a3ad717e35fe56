"""The combo-signal carrier-difference study: B1I + B1C as one signal, and its spoofing test."""

from __future__ import annotations

from collections.abc import Sequence

from sdr_spoof.progress import Stages
from sdr_spoof.reproduce.parallel import workers
from sdr_spoof.reproduce.study import Effort, Section, Study

from . import (
    capture,
    echo_section,
    errata,
    multipath_section,
    phase_jump,
    receiver_section,
    thresholds,
)


def sections(effort: Effort, stages: Stages) -> Sequence[Section]:
    """Every part of the study, in the order of the publication."""
    model = [part.section(effort, stages) for part in (thresholds, capture, phase_jump)]
    with workers(effort.threads) as executor:
        receiver = receiver_section.section(effort, stages, executor)
        echoes = echo_section.section(effort, stages, executor)
    return [*model, receiver, multipath_section.section(effort, stages), echoes]


STUDY = Study(
    name="combo",
    title="Induced spoofing seen by the carrier difference of a combo signal",
    source="Combo-signal model and detection of induced spoofing for BeiDou B1I and B1C: "
    "Neyman-Pearson test on the rate of the carrier difference.",
    errata=errata.errata,
    sections=sections,
    quick_runs=6,
)
