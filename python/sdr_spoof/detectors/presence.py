"""Where the signals of a combo were really there: loops know it too late.

A loop that has lost its signal turns at random for some tenths of a second before its lock
detector, which must average, says so; the C/N0 estimate lags likewise. Rows from such a time would
look like an attack on every satellite that sets or goes behind a house. Here the prompt power is
judged in hindsight, over short windows, and all rows of a window without signal are left out.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterator

import numpy as np
import scipy
from numpy.typing import NDArray

from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.windows import sections
from sdr_spoof.records import ComboTrack, SignalTrack, TrackLog
from sdr_spoof.signals import signal_spec

WINDOW_S = 0.1
"""Length of a window: shorter gaps turn no loop far, and beats of an attack are mostly shorter."""
BELOW_DB = 3.0
"""A window is empty this far below the C/N0 that a test needs: 2.7 sigma at that C/N0, 10 sigma
above noise alone."""
NOISE_CHIPS = 1.5
"""A tap this far from the prompt, or further, sees noise alone."""
NOISE_S = 2.0
"""Noise power is averaged over this."""
_KNOWN: dict[int, dict[tuple[int, float], NDArray[np.bool_]]] = {}
"""Presence in the combos of each log, by its identity, as long as the log lives: several detectors
ask for it. A log's rows do not change."""


def combo_sections(
    log: TrackLog, config: DetectionConfig, lead_s: float
) -> Iterator[tuple[ComboTrack, NDArray[np.bool_], int, int]]:
    """Sections of every combo of a log (:func:`.windows.sections`).

    Each with its rows in which both signals were there, how many rows are those of the section
    before, and the number of its first row in the whole track.
    """
    for number, track in enumerate(log.combos):
        for first, stop, lead in sections(track, lead_s):
            part = track.part(first, stop)
            key = (number, config.min_cn0_dbhz) if track.epochs == part.epochs else None
            yield part, _once(log, key, part, config), lead, first


def _once(
    log: TrackLog, key: tuple[int, float] | None, part: ComboTrack, config: DetectionConfig
) -> NDArray[np.bool_]:
    """:func:`present`, kept for the next detector where the part is a whole track."""
    if id(log) not in _KNOWN:
        _KNOWN[id(log)] = {}
        weakref.finalize(log, _KNOWN.pop, id(log), None)
    known = _KNOWN[id(log)]
    if key is None or key not in known:
        there = present(log, part, config.min_cn0_dbhz)
        there.flags.writeable = False
        if key is None:
            return there
        known[key] = there
    return known[key]


def present(log: TrackLog, combo: ComboTrack, min_cn0_dbhz: float) -> NDArray[np.bool_]:
    """Rows of the combo in which both its signals were there, shape (N,).

    A signal whose own track is not in the log, or has no noise tap, counts as there.
    """
    there = np.ones(combo.epochs, dtype=np.bool_)
    for signal in (combo.lower, combo.upper):
        found = rows_in(log, combo, signal)
        if found is not None:
            track, rows = found
            there &= ~empty(track, min_cn0_dbhz - BELOW_DB)[rows]
    return there


def rows_in(
    log: TrackLog, combo: ComboTrack, signal: str
) -> tuple[SignalTrack, NDArray[np.int64]] | None:
    """The track of one of a combo's signals, and its row for each of the combo's, shape (N,).

    The track reaches beyond the combo by what :func:`empty` needs. None if it is not in the log.
    """
    for whole in log.signals if combo.epochs else ():
        if whole.prn == combo.prn and whole.signal == signal:
            track = whole.between(combo.time_s[0] - NOISE_S, combo.time_s[-1] + NOISE_S)
            rows = np.searchsorted(track.time_s, combo.time_s - 0.5 * combo.integration_s)
            return track, np.minimum(rows, track.epochs - 1)
    return None


def empty(track: SignalTrack, cn0_dbhz: float) -> NDArray[np.bool_]:
    """Rows within any window whose mean prompt power is below the given C/N0, shape (N,)."""
    interval = track.integration_s
    noise_tap = find_noise_tap(track)
    if interval.size == 0 or noise_tap is None:
        return np.zeros(interval.size, dtype=np.bool_)
    epoch_s = float(np.median(interval))
    power, noise = (
        np.abs(track.taps[:, tap].astype(np.complex128)) ** 2 / interval
        for tap in (track.prompt_tap, noise_tap)
    )
    noise = scipy.ndimage.uniform_filter1d(noise, max(round(NOISE_S / epoch_s), 1), mode="nearest")
    excess = power - noise * (1.0 + 10 ** (cn0_dbhz / 10.0) * interval)
    width = round(WINDOW_S / epoch_s) // 2 * 2 + 1
    low = scipy.ndimage.uniform_filter1d(excess, width, mode="nearest") <= 0.0
    # A window stands at its middle row: spread each back over all its rows.
    return np.asarray(scipy.ndimage.binary_dilation(low, np.ones(width, np.bool_)))


def find_noise_tap(track: SignalTrack) -> int | None:
    """Index of the tap that sees noise alone; None where all are near the peak."""
    furthest = int(np.argmax(np.abs(track.tap_offsets_s)))
    chip_s = 1.0 / signal_spec(track.signal).chip_rate_hz
    return furthest if abs(float(track.tap_offsets_s[furthest])) >= NOISE_CHIPS * chip_s else None
