"""Reproduction of published studies: their tables and figures, number by number.

A study is one module or package here and one line in :data:`STUDIES`. It says what the
publication prints, what a correct computation gives, and where the publication is wrong.
"""

from __future__ import annotations

from pathlib import Path

from sdr_spoof.errors import ConfigError
from sdr_spoof.progress import Stages, silent

from . import array, combo, ins_rate, ship, sprt_dme
from .output import check_folder, summary, write
from .study import Effort, Reproduction, Study

__all__ = ["STUDIES", "Effort", "Reproduction", "Study", "find", "reproduce", "summary"]

STUDIES: dict[str, Study] = {
    study.name: study
    for study in (
        combo.STUDY,
        ins_rate.STUDY,
        ship.STUDY,
        sprt_dme.STUDY,
        array.STUDY,
    )
}
"""Every study, by name."""


def find(name: str) -> Study:
    """The study of that name; raises ConfigError that lists the known ones."""
    if name not in STUDIES:
        raise ConfigError(f"unknown study '{name}'; known studies: {', '.join(STUDIES)}")
    return STUDIES[name]


def reproduce(
    name: str,
    folder: Path | str,
    *,
    quick: bool = False,
    runs: int | None = None,
    seed: int = 0,
    threads: int = 1,
    force: bool = False,
    stages: Stages = silent,
) -> Reproduction:
    """Reproduce a published study and write its tables, figures and report to a folder.

    Args:
        name: which study, see :data:`STUDIES`.
        folder: where to write; made where it does not exist.
        quick: few Monte Carlo runs, under half a minute.
        runs: runs of the whole receiver for each point, instead of the study's own number.
        seed: other than 0: fresh random numbers, so that nothing was chosen with them in view.
        threads: workers; the numbers do not depend on it.
        force: replace an earlier reproduction in the folder.
        stages: shows the progress of each part.

    Raises:
        ConfigError: no such study, or one that knows no seed.
        OutputError: the folder holds such results already, or cannot be written.
    """
    study, folder = find(name), Path(folder)
    check_folder(folder, study, force=force)
    if seed and not study.seeded:
        raise ConfigError(f"the study '{name}' has no fresh random numbers; leave out the seed")
    count = runs or (study.quick_runs if quick else study.full_runs)
    effort = Effort(count, threads, quick, seed)
    sections = study.sections(effort, stages)
    return write(Reproduction(study, effort, sections, study.errata()), folder, force=force)
