"""Settings and numbers of the publication, and those of the study of it.

H. Chang, C. Pang, L. Zhang, Z. Guo, M. Lyu, Q. Wu, "An INS-Assisted BDS Pseudorange Rate
Consistency Deception Signal Detection Method", Journal of Air Force Engineering University 23 (4),
2022.
"""

from __future__ import annotations

from scipy.stats import norm

DURATION_S = 1750.0
TESTED = 1500
"""Epochs that the false alarms of its table 5 are counted over, 1 s each."""
TRAINED_S = 200.0
PFA, PD = 0.01, 0.9
NAMES = ("east", "north")
RATE_M_S = (0.2071, 0.1366)
"""Thresholds of the rate form, east and north."""
POSITION_M = (58.5951, 58.1481)
GRADES = ("n1", "n2")
COUNTS = {
    ("position", "n1"): (432, 478),
    ("position", "n2"): (617, 648),
    ("rate", "n1"): (37, 43),
    ("rate", "n2"): (88, 94),
}
"""False alarms in table 5, east and north."""
PRINTED_PERCENT = {
    ("position", "n1"): (28.8, 31.86),
    ("position", "n2"): (41.13, 43.2),
    ("rate", "n1"): (2.46, 2.86),
    ("rate", "n2"): (5.86, 6.26),
}
HOVER_S = (25.0, 50.0)
DRAG_S, DRAG_M_S = (650.0, 750.0), 0.1
"""Northwards."""
STEP_S, STEP_M = (1500.0, 1550.0), 100.0
"""Eastwards."""

QUANTILE = float(norm.isf(PFA / 2))
RATE_SIGMA_M_S = tuple(t / QUANTILE for t in RATE_M_S)
"""Noise that the printed thresholds mean, two-sided."""
POSITION_SIGMA_M = tuple(t / QUANTILE for t in POSITION_M)

STATIC_S = (200, 650, 1500, 1749)
GYRO_M_S = (0.0945, 0.949, 3.95, 4.80)
"""North velocity error of a gyro bias of 0.1 deg/h about east at those times."""
ACCELEROMETER_M_S = (0.0194, 0.0570, 0.0749, 0.0639)
"""East velocity error of an accelerometer bias of 10 ug."""

FALSE_ALARMS = {
    ("rate", "n1"): ((70, 73), 5),
    ("rate", "n2"): ((87, 88), 4),
    ("position", "n1"): ((65, 61), 6),
    ("position", "n2"): ((80, 79), 5),
    ("realigned", "n1"): ((0.5, 10), 4),
}
"""In percent, by an independent simulation: east and north, and the tolerance."""
PERFECT_GYRO = {"rate": (0, 4), "position": (5, 9)}
"""Likewise, for accelerometer biases of 10 ug alone."""
