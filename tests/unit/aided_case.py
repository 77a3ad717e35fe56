"""A made-up result of aiding: three of ten satellites lead GNSS away, and are left out."""

from __future__ import annotations

import numpy as np

from sdr_spoof.aided.judge import judge
from sdr_spoof.aided.records import AidedTrack, Guard, Monitor, SmoothedTrack, Use
from sdr_spoof.aided.run import Aided
from sdr_spoof.aiding import simulated as sim
from sdr_spoof.nav.geodesy import enu_matrix, geodetic_to_ecef
from sdr_spoof.nav.time import GnssTime

EPOCHS = 120
TIME = np.arange(EPOCHS, dtype=np.float64)
PLACE = geodetic_to_ecef([34.0, 122.0, 20.0])
AXES = enu_matrix(34.0, 122.0)
NAMES = ("C19", "C20", "C23", "C25", "C27", "C30", "C36", "C37", "G05", "G12")
REFERENCE = GnssTime(1_362_571_218)
ATTACK = (TIME >= 60) & (TIME < 100)


def truth_m():
    angle = TIME / 30
    local = np.stack([200 * np.sin(angle), 200 * (1 - np.cos(angle)), 0 * angle], axis=1)
    return PLACE + local @ AXES


def track(guard=None, use=None) -> AidedTrack:
    random, truth = np.random.default_rng(1), truth_m()
    pull = np.where(ATTACK, 2.0 * (TIME - 60), 0.0)[:, None] * AXES[0]
    if guard is None:
        guard = np.full(EPOCHS, Guard.TRUSTED, np.uint8)
        guard[:10] = Guard.STARTING
        guard[62:66] = Guard.DECIDING
        guard[66:110] = Guard.PARTIAL
    if use is None:
        use = np.full((EPOCHS, len(NAMES)), Use.USED, np.uint8)
        use[66:110, [1, 4, 6]] = Use.EXCLUDED
        use[70:100, 2] = Use.NAMED
    still = np.zeros((EPOCHS, 3))
    ones = np.ones(EPOCHS)
    return AidedTrack(
        REFERENCE,
        TIME,
        truth + random.normal(0, 0.3, (EPOCHS, 3)),
        still,
        still,
        np.ones((EPOCHS, 3)),
        5 * ones,
        6 * ones,
        truth + pull + random.normal(0, 1.0, (EPOCHS, 3)),
        NAMES,
        use,
        guard,
    )


def smoothed() -> SmoothedTrack:
    still = np.zeros((EPOCHS, 3))
    return SmoothedTrack(truth_m() + 0.1 * AXES[0], still, still, 0.2 * np.ones((EPOCHS, 3)))


def monitor(name="codes", unit="", alarm_s=None, log10_p=-9.0, tested=EPOCHS) -> Monitor:
    value = np.where(ATTACK & (alarm_s is not None), 3.0, 0.5)
    value[tested:] = np.nan
    onset = None if alarm_s is None else alarm_s - 1.0
    return Monitor(name, TIME, value, np.ones(EPOCHS), unit, alarm_s, onset, log10_p, unit == "m/s")


def aided() -> Aided:
    found = track()
    monitors = (monitor("codes of 10 s", alarm_s=62.0), monitor("place against old copies"))
    residuals = tuple(monitor(n, "m/s", 61.0 if n == "east" else None) for n in ("east", "north"))
    sky = sim.fixed(TIME, PLACE, [(36 * k, 30 + 3 * k) for k in range(10)], NAMES)
    still = np.zeros((EPOCHS, 3))
    measured = sim.simulate((truth_m(), still), sky, TIME, reference=REFERENCE).run()
    verdict = judge(found, (*monitors, *residuals), ("one note",), "Slow drags.", 1e3)
    return Aided(verdict, measured, None, found, monitors, residuals, 1e-5)
