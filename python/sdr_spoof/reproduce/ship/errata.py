"""What the publication leaves open or has wrong, and what is done instead."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.reproduce.study import Erratum

if TYPE_CHECKING:
    from collections.abc import Sequence


def errata() -> Sequence[Erratum]:
    """In the order of the publication."""
    return (
        Erratum(
            "Formulas lost",
            "The statistics R of position, velocity, pseudorange and rate are described in words "
            "(a sliding, normalised, correlated accumulation over L points); the formulas are "
            "not in the text.",
            "Three readings, all available: mean square (default, 0 <= R <= 1 when clean by "
            "construction), lag-1 product, coherent square.",
        ),
        Erratum(
            "Divided by the largest deviation",
            "sigma is the largest deviation without interference.",
            "It is 3.6 standard deviations of the noise (and grows with the length of the "
            "calibration): biases below three sigma are never seen. Divided by the largest clean "
            "value of R itself, one sigma is seen within half a minute.",
        ),
        Erratum(
            "Attacked: all R over 1",
            "The system is under attack when every R exceeds 1.",
            "Satellites are not displaced alike: divided as printed, it happens in none of the "
            "runs of 1 m/s and less, and in under half of those of 2 m/s. The share of the "
            "statistics that are over 1 is given as a severity besides the three words.",
        ),
        Erratum(
            "No satellite named",
            "Channels with R over 1 are left out.",
            "R of position or velocity may be over 1 with no channel named; all are left out then.",
        ),
        Erratum(
            "The closed loop hides the attack",
            "The filtered INS is the reference of the test.",
            "It follows drags slower than some 0.5 m/s without a trace. Here copies that have not "
            "used GNSS for 15 to 300 s are references, and innovations are tested over windows up "
            "to 100 s, whitened against the coloured noise of codes.",
        ),
        Erratum(
            "Lock-out",
            "Excluded channels are isolated; nothing is said of how they come back.",
            "Against a displaced INS the true signals are excluded for ever. An alarm goes back to "
            "a trusted copy; a step back of the fix that ends in agreement, or an alarm that the "
            "tests do not confirm, readmits.",
        ),
        Erratum(
            "Eleven states",
            "Position, velocity, attitude, clock, drift.",
            "With the biases of gyros and accelerometers (17 states, default) the INS coasts twice "
            "as well.",
        ),
    )
