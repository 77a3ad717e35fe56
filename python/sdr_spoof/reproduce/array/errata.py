"""Errors of the publication, each with what is done instead and the number that shows it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.reproduce.study import Erratum

if TYPE_CHECKING:
    from collections.abc import Sequence


def errata() -> Sequence[Erratum]:
    """Known errors, in the order of the argument."""
    return (
        Erratum(
            "Decimal points of the coordinates",
            "R0 = (29929 km, 20957 km, 5128 km) and likewise, lost in the text that we have.",
            "R0 = (2992.90, 2095.70, 5128) km, spoofer (2993.7, 2094.2, 5128.7) km: the only "
            "reading near the Earth's surface that gives the way of more than 200 m.",
        ),
        Erratum(
            "Whole cycles of the phase differences",
            "Not mentioned; they cancel only as long as the array does not turn.",
            "All that give a direction are tried; ignored, a turn of 10 degrees gives false alarms "
            "in more than 90 % of clean runs.",
        ),
        Erratum(
            "Attitude",
            "Only the yaw is compensated, by equation 8, since roads are nearly level.",
            "A change of tilt of 2 degrees alone alarms in 44 % of clean runs. Directions are "
            "completed to unit length and turned by yaw, pitch and roll.",
        ),
        Erratum(
            "Error of the INS",
            "The turn alpha is taken as known.",
            "An error of yaw of 1 degree alarms in 10 % of clean runs at 30 degrees of elevation; "
            "its variance enters the covariance along the direction in which it moves a source.",
        ),
        Erratum(
            "Standing satellites",
            "The satellite's direction is constant over the motion.",
            "Over 120 s its motion alone alarms in about one of ten clean runs; it is taken off by "
            "its ephemeris.",
        ),
        Erratum(
            "Coverage",
            "200 m of motion detect spoofers in 95 % of the region within 2 km.",
            "A Pd of 0.95 is reached in 88 % of the half ball and 80 % of the ground; 95 % of them "
            "need 354 m and 777 m.",
        ),
        Erratum(
            "The displacement is not used",
            "Any change of direction counts, in both components (chi-square, 2 degrees).",
            "The INS knows the way gone, which fixes the direction of the change: one degree of "
            "freedom, one-sided, and all epochs of the way instead of two.",
        ),
        Erratum(
            "Statistic of Figure 6",
            'The axis is called lambda and "practically zero" for a satellite.',
            "What is measured is nu, whose mean is 2 for a satellite; lambda is the noncentrality "
            "of its law.",
        ),
    )
