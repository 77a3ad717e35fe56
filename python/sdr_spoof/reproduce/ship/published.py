"""Numbers of the study of the published method, which the acceptance numbers compare with.

The publication is a Chinese patent of a ship-borne terminal (identification and filtering of
spoofing signals); it prints no numbers and its formulas are lost. The numbers are those of a
simulation of it with the same sensors.
"""

from __future__ import annotations

CLEAN_M = (1.7, 0.3)
"""Horizontal RMS and tolerance of the filter with white noise."""
NIS = (0.35, 0.47)
"""Square of the innovations over their number (20)."""
CAPTURED_M = {0.2: 80.0, 0.5: 200.0, 1.0: 399.0, 2.0: 797.0}
"""Error at the end of a drag of 400 s in m/s, without exclusion."""
CAPTURED_TOLERANCE = 0.03
COASTING_S = (60, 120, 300, 398)
COASTING_M = {
    ("A", 11): (2.0, 7.0, 53.0, 107.0),
    ("A", 17): (2.0, 4.0, 26.0, 50.0),
    ("B", 17): (4.0, 17.0, 161.0, 332.0),
}
"""Median error after so long without GNSS, by grade and states."""
COASTING_TOLERANCE = 0.35
ROBUST_S = {
    "all_0.2": 9.0,
    "all_0.5": 0.0,
    "all_1": 0.0,
    "all_2": 0.0,
    "all_0.02_s2": 13.0,
    "all_0.005_s2": 54.0,
    "three_0.5": 0.0,
    "three_0.005_s2": 18.0,
    "code_1": 19.0,
    "clock_1": 0.0,
}
"""Delays of the study's robust set, grade A, 17 states."""
FLOOR = {"all_0.001_s2": 0.12, "all_0.002_s2": 0.54}
"""Share of runs in which drags at the floor are found."""
LITERAL_DELAY = {4: 8, 6: 4, 10: 2}
"""Epochs until R as printed sees a bias of so many sigma in white noise, L = 10."""
SELF_DELAY = {2: 6, 3: 3}
"""The same where R is divided by its own clean maximum."""
GLITCH = 0.85
"""Share in which one glitch of 12 sigma alarms the mean square."""
LITERAL_M = (195.0, 205.0)
"""Largest error of the literal closed loop in a drag of 0.5 m/s."""
LOCKED_M = 100.0
"""It is still further off than this at 1490 s."""
FALSE_ALARMS = 0.02
CLEAN_RUNS = 3
"""Clean runs are so many times those of an attack."""
BACK_M = 5.0
BACK_S = 120.0
"""Error so long after the end of a detected attack."""
