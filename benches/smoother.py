"""Smoother against filter on the ship's study: python benches/smoother.py [runs]."""

import sys
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from sdr_spoof.aided.run import with_hardware
from sdr_spoof.aiding.simulated import ReceiverNoise
from sdr_spoof.config import Config
from sdr_spoof.reproduce.ship.attacks import LIST
from sdr_spoof.reproduce.ship.clean_section import SETTLED, band, nees
from sdr_spoof.reproduce.ship.simulation import (
    Case,
    default_set,
    errors_ned_m,
    runs,
    velocity_errors_ned_m_s,
    voyage,
)

RUNS = int(sys.argv[1]) if len(sys.argv) > 1 else 100
FIRST = 8000
BEGIN = 700
ATTACKS = ("all_0.2", "all_0.5", "all_0.005_s2", "three_0.5", "three_0.005_s2", "clock_1")


@dataclass
class Errors:
    """Of R runs and E epochs."""

    level: np.ndarray
    """Horizontal, m (R, E)."""
    down: np.ndarray
    velocity: np.ndarray
    attitude: np.ndarray
    nees: np.ndarray
    """Of position, velocity and attitude (R, 3, E)."""


def errors(case):
    """Of the filter and of the smoother."""
    kept = ([], [])
    for s in runs(case):
        later = {name: getattr(s.smoothed, name) for name in vars(s.smoothed)}
        for rows, solution in zip(kept, (s, replace(s, **later)), strict=True):
            rows.append(_of(solution))
    return [Errors(*(np.array(part) for part in zip(*rows, strict=True))) for rows in kept]


def _of(solution):
    place, velocity = errors_ned_m(solution), velocity_errors_ned_m_s(solution)
    true, said = (
        Rotation.from_euler("ZYX", a) for a in (voyage().truth.attitude_rad, solution.attitude_rad)
    )
    turned = (true * said.inv()).as_rotvec()
    each = [
        nees(error, solution.covariance[:, k]) for k, error in enumerate((place, velocity, turned))
    ]
    size = np.linalg.norm
    return (
        size(place[:, :2], axis=1),
        place[:, 2],
        size(velocity, axis=1),
        size(turned, axis=1),
        each,
    )


def rms(values):
    """Over everything."""
    return float(np.sqrt(np.mean(values**2)))


def clean(title, **settings):
    """RMS and NEES without an attack."""
    filtered, smoothed = errors(Case(config=default_set(smooth=True, **settings), **SIZE))
    for kind, unit in (("level", "m"), ("down", "m"), ("velocity", "m/s"), ("attitude", "rad")):
        a, b = (rms(getattr(e, kind)[:, SETTLED:]) for e in (filtered, smoothed))
        print(f"{title}: {kind} {a:.3g} {b:.3g} {unit}, {a / b:.2f} times better")
    for name, e in (("filter", filtered), ("smoother", smoothed)):
        print(f"{title}: NEES of the {name}", e.nees[:, :, SETTLED:].mean(axis=(0, 2)).round(2))


def outage(title, length, noise=None, grade="ship-a", **settings):
    """Errors within an outage of so many seconds."""
    believed = {"smooth": True, "exclusion": "off", "outages_s": [(BEGIN, BEGIN + length)]}
    believed |= {"clock_drift_m2_s3": 0.0004} | settings
    told = Config.model_validate({"aided": {"grade": grade, "oscillator": ""}, "tight": believed})
    config = with_hardware(told).tight
    case = Case(grade=grade, config=config, noise=noise or ReceiverNoise(), **SIZE)
    filtered, smoothed = errors(case)
    for name, epoch in (("middle", BEGIN + length // 2), ("end", BEGIN + length - 1)):
        a, b = (rms(e.level[:, epoch]) for e in (filtered, smoothed))
        print(f"{title}, {length} s: {name} {a:.2f} {b:.2f} m, {a / b:.1f} times better")
    inside = slice(BEGIN, BEGIN + length)
    for name, e in (("filter", filtered), ("smoother", smoothed)):
        print(f"{title}, {length} s: NEES of the {name} {e.nees[:, 0, inside].mean():.2f}")


def attacked(named):
    """Errors during an attack and after it."""
    case = Case(attacks=(named.attack,), config=default_set(smooth=True), **SIZE)
    filtered, smoothed = errors(case)
    for name, part in (("during", slice(600, 1000)), ("after", slice(1120, 1500))):
        a, b = (e.level[:, part] for e in (filtered, smoothed))
        most = [float(np.median(e.max(axis=1))) for e in (a, b)]
        print(
            f"{named.title}, {name}: {rms(a):.2f} {rms(b):.2f} m; largest, median of runs "
            f"{most[0]:.1f} {most[1]:.1f} m; NEES of the smoother "
            f"{smoothed.nees[:, 0, part].mean():.2f}"
        )


SIZE = {"runs": RUNS, "first": FIRST}
print("95 % band of NEES", [round(b, 2) for b in band(RUNS)])
clean("clean")
clean("phase of 2 mm", carrier_noise_m=0.002)
for grade in ("ship-a", "ship-b", "tactical", "industrial"):
    outage(f"outage, {grade}", 60, grade=grade)
    white = ReceiverNoise(code_markov_m=0.0)
    outage(f"outage, {grade}, white codes", 60, white, grade, code_wander_m=0.0)
outage("outage, ship-a", 300)
for named in LIST:
    if named.name in ATTACKS:
        attacked(named)
