"""What a reproduced study is made of: sections with tables, pictures and acceptance numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from sdr_spoof.progress import Stages

Cell = str | int | float | bool | None
"""A value of a table; None where there is none."""


@dataclass(frozen=True)
class Effort:
    """How much Monte Carlo a reproduction runs; the numbers depend on ``runs`` alone."""

    runs: int
    """Runs of the whole receiver for each point of a sweep."""
    threads: int = 1
    quick: bool = False
    """Leave out what takes minutes even with few runs."""
    seed: int = 0
    """Other than 0: fresh random numbers, of studies that are ``seeded``."""

    @property
    def draws(self) -> int:
        """Draws for each point where a run costs next to nothing."""
        return 100 * self.runs


@dataclass(frozen=True)
class Table:
    """One CSV file, and a table in the HTML."""

    name: str
    """Name of its file, without the ending."""
    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    note: str = ""
    shown: bool = True
    """False for long series that only the CSV holds."""
    details: Sequence[str] = ()
    """Columns that the HTML leaves out."""

    def brief(self) -> tuple[list[str], list[list[Cell]]]:
        """Columns and rows without the details."""
        kept = [k for k, name in enumerate(self.columns) if name not in self.details]
        return [self.columns[k] for k in kept], [[row[k] for k in kept] for row in self.rows]


@dataclass(frozen=True)
class Picture:
    """One PNG file, and a figure in the HTML."""

    name: str
    """Name of its file, without the ending."""
    title: str
    png: bytes
    caption: str


@dataclass(frozen=True)
class Number:
    """An acceptance number: a value, and the interval in which it must lie."""

    name: str
    what: str
    value: float
    low: float
    high: float
    unit: str = ""
    reference: float | None = None
    """What the publication or the study of it says, None where it says nothing."""

    @property
    def met(self) -> bool:
        """Whether the value lies in its interval."""
        return bool(self.low <= self.value <= self.high)


@dataclass(frozen=True)
class Erratum:
    """An error of the publication and how it is resolved here."""

    title: str
    printed: str
    resolution: str


@dataclass(frozen=True)
class Section:
    """One part of a study."""

    title: str
    text: Sequence[str] = ()
    tables: Sequence[Table] = ()
    pictures: Sequence[Picture] = ()
    numbers: Sequence[Number] = ()
    skipped: Sequence[str] = ()
    """What could not be done, and why, in one sentence each."""


@dataclass(frozen=True)
class Study:
    """One published study, one line of the registry."""

    name: str
    title: str
    source: str
    errata: Callable[[], Sequence[Erratum]]
    sections: Callable[[Effort, Stages], Sequence[Section]]
    full_runs: int = 1000
    quick_runs: int = 10
    """Under half a minute on two cores."""
    seeded: bool = False
    """Whether it can be run with fresh random numbers."""


@dataclass(frozen=True)
class Reproduction:
    """What :func:`sdr_spoof.reproduce.reproduce` has made."""

    study: Study
    effort: Effort
    sections: Sequence[Section]
    errata: Sequence[Erratum]
    files: Sequence[str] = field(default=())
    """Names of the files in the folder."""

    @property
    def numbers(self) -> list[Number]:
        """Acceptance numbers of all sections."""
        return [n for s in self.sections for n in s.numbers]

    @property
    def met(self) -> bool:
        """Whether every acceptance number lies in its interval."""
        return all(n.met for n in self.numbers)


def near(
    name: str, what: str, value: float, reference: float, tolerance: float, unit: str = ""
) -> Number:
    """An acceptance number that must lie within a tolerance of its reference."""
    low, high = reference - tolerance, reference + tolerance
    return Number(name, what, value, low, high, unit, reference)
