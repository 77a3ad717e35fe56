"""RINEX 3.05 observation files.

Source: RINEX, the receiver independent exchange format, version 3.05 (IGS/RTCM-SC104, 2020):
section 6.5 and tables A2, A3 (header and data records), table A23 (phase alignment). Times are
GPST. What RINEX has no code for, the subcarrier's pseudorange, stays out.

A pseudorange that is not as good as its strength says, since its code loop settles, is left blank:
a user of the file has nothing but the strength to weigh it by. Its phase stays, whose
loss-of-lock indicator says that it began anew. Where the receiver's clock was set anew, samples
being missing, the flag of the epoch says "power failure" (table A3): nothing holds across.
"""

from __future__ import annotations

import math
from collections import defaultdict
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.nav.time import leap_seconds
from sdr_spoof.observations import SUBCARRIER
from sdr_spoof.signals import signal_ids, signal_spec

from .atomic import write_bytes

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime
    from sdr_spoof.observations import Observations

LOST, HALF = 1, 2
"""Bits of the loss-of-lock indicator."""
CODES_A_LINE = 13
UNSETTLED_M = 1.0
"""Pseudoranges that may be off by more than this beyond their noise, one sigma, are left blank."""
GOOD, POWER_FAILURE = 0, 1
"""Epoch flags."""


def write_rinex_obs(
    path: Path,
    observations: Observations,
    *,
    position_m: NDArray[np.float64] | None = None,
    marker: str = "SDR-SPOOF",
    keep_spoofed: bool = False,
    force: bool = False,
) -> None:
    """Write observations as RINEX 3.05.

    What the detectors call spoofed is left out, and a comment says so, unless ``keep_spoofed``.
    ``position_m`` (3,) is the approximate position, ECEF. The date of the file is that of its last
    epoch, so that the same observations give the same bytes.

    Raises:
        OutputError: it exists and ``force`` is not set, or it cannot be written.
    """
    table = _Table(observations, keep_spoofed)
    lines = [*_header(table, position_m, marker), *_epochs(table)]
    write_bytes(path, "".join(f"{line}\n" for line in lines).encode("ascii"), force=force)


class _Table:
    """Observations by satellite, and which signals each system has."""

    def __init__(self, observations: Observations, keep_spoofed: bool) -> None:
        self.seen = observations
        self.left_out = observations.spoofed & (not keep_spoofed)
        unsettled_m = observations.unsettled_m
        self.blank = np.zeros(self.left_out.shape, np.bool_)
        """Pseudoranges that are not written."""
        if unsettled_m is not None:
            self.blank = np.nan_to_num(unsettled_m) > UNSETTLED_M
        order = signal_ids()
        self.columns: dict[str, dict[str, int]] = defaultdict(dict)
        """Column of each signal of each satellite."""
        for i, signal in enumerate(observations.signals):
            if signal.signal != SUBCARRIER:
                self.columns[signal.satellite][signal.signal] = i
        self.signals: dict[str, list[str]] = {}
        for name in sorted(self.columns):
            known = set(self.signals.get(name[0], ())) | set(self.columns[name])
            self.signals[name[0]] = sorted(known, key=order.index)


def _line(content: str, label: str) -> str:
    return f"{content:<60.60}{label:<20}".rstrip()


def _header(table: _Table, position_m: NDArray[np.float64] | None, marker: str) -> Iterator[str]:
    seen = table.seen
    system = next(iter(table.signals)) if len(table.signals) == 1 else "M"
    place = np.zeros(3) if position_m is None else position_m
    yield _line(f"{3.05:9.2f}{'':11}{'OBSERVATION DATA':20}{system}", "RINEX VERSION / TYPE")
    last = seen.time(-1) if seen.epochs else seen.reference
    date = f"{last.utc():%Y%m%d %H%M%S} UTC"
    yield _line(f"{'sdr-spoof':20}{'':20}{date}", "PGM / RUN BY / DATE")
    yield from _comments(table)
    yield _line(marker, "MARKER NAME")
    yield _line("NON_GEODETIC", "MARKER TYPE")
    yield _line("", "OBSERVER / AGENCY")
    yield _line(f"{'':20}{'sdr-spoof':20}{_version()}", "REC # / TYPE / VERS")
    yield _line("", "ANT # / TYPE")
    yield _line("".join(f"{x:14.4f}" for x in place), "APPROX POSITION XYZ")
    yield _line(f"{0:14.4f}" * 3, "ANTENNA: DELTA H/E/N")
    for letter, signals in table.signals.items():
        yield from _types(letter, signals)
    yield _line("DBHZ", "SIGNAL STRENGTH UNIT")
    yield _line(f"{seen.interval_s:10.3f}", "INTERVAL")
    if seen.epochs:
        yield _line(_header_time(seen.time(0)), "TIME OF FIRST OBS")
        yield _line(_header_time(seen.time(-1)), "TIME OF LAST OBS")
    yield _line(f"{0:6d}", "RCV CLOCK OFFS APPL")
    for letter, signals in table.signals.items():
        for signal in signals:
            spec = signal_spec(signal)
            shift = f"{letter} L{spec.rinex} {spec.phase_offset_cycles:8.5f}"
            yield _line(shift, "SYS / PHASE SHIFT")
    yield _line(f"{leap_seconds(last.utc()):6d}", "LEAP SECONDS")
    yield _line(f"{len(table.columns):6d}", "# OF SATELLITES")
    yield _line("", "END OF HEADER")


def _comments(table: _Table) -> Iterator[str]:
    """Satellites that are left out as spoofed, and from when on; and what blanks mean."""
    seen = table.seen
    if (table.blank & np.isfinite(seen.pseudorange_m)).any():
        yield _line(f"C is blank where it may be off by over {UNSETTLED_M:g} m", "COMMENT")
    for name, columns in sorted(table.columns.items()):
        gone = table.left_out[:, list(columns.values())].any(axis=1)
        if gone.any():
            since = seen.time(int(gone.argmax())).calendar()
            yield _line(
                f"{name} left out as spoofed from {since:%Y-%m-%d %H:%M:%S} GPST", "COMMENT"
            )


def _types(letter: str, signals: Sequence[str]) -> Iterator[str]:
    """Observation codes of a system: C, L, D and S of each signal."""
    codes = [kind + signal_spec(s).rinex for s in signals for kind in "CLDS"]
    for i in range(0, len(codes), CODES_A_LINE):
        head = f"{letter}  {len(codes):3d}" if i == 0 else " " * 6
        row = "".join(f" {code}" for code in codes[i : i + CODES_A_LINE])
        yield _line(head + row, "SYS / # / OBS TYPES")


def _header_time(time: GnssTime) -> str:
    d, second = time.calendar(), _second(time)
    return f"{d.year:6d}{d.month:6d}{d.day:6d}{d.hour:6d}{d.minute:6d}{second:13.7f}     GPS"


def _second(time: GnssTime) -> float:
    """Second of the minute, to the tenth of a microsecond that is written."""
    return time.seconds % 60 + math.floor(time.fraction * 1e7 + 0.5) * 1e-7


def _epochs(table: _Table) -> Iterator[str]:
    seen = table.seen
    present = np.isfinite(seen.cn0_dbhz) & ~table.left_out
    flags = _flags(seen)
    for epoch in range(seen.epochs):
        rows = [
            name + "".join(_cells(table, epoch, present[epoch], name))
            for name, columns in sorted(table.columns.items())
            if any(present[epoch, i] for i in columns.values())
        ]
        if not rows:
            continue
        d, second = seen.time(epoch).calendar(), _second(seen.time(epoch))
        yield (
            f"> {d.year:4d} {d.month:02d} {d.day:02d} {d.hour:02d} {d.minute:02d}{second:11.7f}"
            f"  {flags[epoch]}{len(rows):3d}"
        )
        yield from (row.rstrip() for row in rows)


def _cells(table: _Table, epoch: int, present: NDArray[np.bool_], satellite: str) -> Iterator[str]:
    """Sixteen characters for each observation code of a satellite's system."""
    for signal in table.signals[satellite[0]]:
        i = table.columns[satellite].get(signal)
        if i is None or not present[i]:
            yield " " * 64
        else:
            yield from _signal_cells(table, epoch, i)


def _flags(seen: Observations) -> NDArray[np.intp]:
    """Of each epoch (E,): whether the clock was set anew since the one before."""
    starts = [] if seen.clock is None else [p.sample_s for p in seen.clock.pieces[1:]]
    piece = np.searchsorted(starts, seen.sample_time_s, side="right")
    return np.asarray(np.where(np.diff(piece, prepend=piece[:1]) > 0, POWER_FAILURE, GOOD))


def _signal_cells(table: _Table, epoch: int, i: int) -> Iterator[str]:
    seen = table.seen
    range_m = math.nan if table.blank[epoch, i] else float(seen.pseudorange_m[epoch, i])
    cn0 = float(seen.cn0_dbhz[epoch, i])
    strength = str(min(max(int(cn0 / 6.0), 1), 9))
    flags = LOST * int(seen.lock_lost[epoch, i]) + HALF * int(seen.half_cycle[epoch, i])
    yield _cell(range_m, " ", strength)
    yield _cell(seen.carrier_phase_cycles[epoch, i], str(flags) if flags else " ", strength)
    yield _cell(seen.doppler_hz[epoch, i], " ", strength)
    yield _cell(cn0, " ", " ")


def _cell(value: float, indicator: str, strength: str) -> str:
    return f"{value:14.3f}{indicator}{strength}" if math.isfinite(value) else " " * 16


def _version() -> str:
    try:
        return version("sdr-spoof")
    except PackageNotFoundError:  # run from the sources
        return ""
