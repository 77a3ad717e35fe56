"""Errors of the publication, each with what is done instead and the numbers that show it."""

from __future__ import annotations

from collections.abc import Sequence

from sdr_spoof.reproduce.study import Erratum

from .drift_section import compass_deg
from .flight_section import end_velocity_error


def errata() -> Sequence[Erratum]:
    """Known errors, the gravest first."""
    return (
        Erratum(
            "Free inertial drift contradicts table 5",
            "False alarms of 2 to 6 % (rate) and 29 to 43 % (position) over 1500 s.",
            "A constant gyro bias of 0.1 deg/h gives a velocity error of R eps (1 - cos w t): "
            "0.095, 0.95, 3.95 and 4.80 m/s after 200, 650, 1500 and 1749 s. Over random flights "
            "the printed thresholds are exceeded in 70 % (N1) to 90 % (N2) of the epochs, in the "
            "rate form more often than in the position form. The printed shares need gyros of 0.01 "
            "deg/h or better, or an alignment every four minutes.",
        ),
        Erratum(
            "The mean without an attack is not zero",
            "The t-test (equations 19 to 26) takes clean data as N(0, sigma).",
            "With K = 10 it rejects 94 to 100 % of the clean windows after 500 s. Tested instead: "
            "a local mean against the line through the minute before, the same with the errors of "
            "the INS in its variance, and a filter that learns them.",
        ),
        Erratum(
            "The drag is below its threshold",
            "A drag of 0.1 m/s is seen at a threshold of 0.1366 m/s (figure 9).",
            "One sample finds it with a probability of 0.245 (north) or 0.091 (east); at Pfa 0.01 "
            "and Pd 0.9 a normal test needs 5 and 10 samples, a t-test 8 and 14. What the figure "
            "would show at 650 to 750 s is the drift of the INS.",
        ),
        Erratum(
            "A position step is a spike of the rate",
            "The rate exceeds its threshold throughout the step of 1500 to 1550 s.",
            "It is +100 m/s in the epoch in which the step comes, -100 m/s in that in which it "
            "goes, nothing between. Alarms latch.",
        ),
        Erratum(
            "Equation 8 is a mean over the epoch",
            "It is compared with the velocity of the INS at the end of the epoch (equation 17).",
            f"An acceleration a adds a/2: {end_velocity_error():.2f} m/s in a turn of 3.7 m/s². "
            "Compared here with the displacement of the INS over the same interval.",
        ),
        Erratum(
            "Signs, units, an inequality",
            "Step 4 declares when the required probability exceeds the achieved one; equation 8 "
            "lacks 1/T; equation 7 has the sign of the other line of sight; equation 16 lost a "
            "cross product; G is called Earth-fixed to local; equation 27 is one-sided, 24 to 26 "
            "two-sided.",
            "Declared only where the achieved probability reaches the required one; rates are "
            "divided by the interval; with the line of sight from satellite to receiver the range "
            "rate is -(v_s - v) . I; the Coriolis term is a product; G turns local into "
            "Earth-fixed axes; all tests are two-sided.",
        ),
        Erratum(
            "Perfect heading",
            "The initial attitude is taken as known.",
            f"Gyro-compassing with N1 leaves up to {compass_deg():.2f} degrees of heading, 0.3 m/s "
            "across the track at 40 m/s. Heading is an uncertain state of the tests here.",
        ),
        Erratum(
            "Noise of differenced phase",
            "Samples are taken as independent.",
            "A phase enters two changes: MA(1), correlation -1/2. The mean of K samples falls as "
            "1/K, and fewer samples are needed.",
        ),
        Erratum(
            "Clocks in equation 17",
            "Receiver and satellite clock drift stay in the expected rate.",
            "Satellite clocks are taken off by their broadcast model, the receiver's is solved for "
            "by least squares with the displacement, or by the other satellites in the form for "
            "each satellite.",
        ),
    )
