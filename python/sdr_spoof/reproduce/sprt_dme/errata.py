"""Errors of the publication, and what is done instead."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.reproduce.study import Erratum

if TYPE_CHECKING:
    from collections.abc import Sequence


def errata() -> Sequence[Erratum]:
    """Known errors, in the order of the publication's argument."""
    return (
        Erratum(
            "Detection quantity (equation 13)",
            "Delta_j shows which satellite is spoofed.",
            "It is a fitted value: it contains the receiver's clock and moves healthy satellites "
            "with the spoofed one. A clean satellite is flagged with probability .2, .97 and 1 "
            "for 10, 15 and 25 m at 3.4 m of noise. The differences or the parity vector isolate.",
        ),
        Erratum(
            "DME in the fit (equations 10 to 13)",
            "DME brings the fitted value nearer to the truth.",
            "Its weight is (sigma GNSS / sigma DME)²: the diagonal of H changes by 2e-4, the "
            "share found by nothing. As a channel of its own DME decides two cases, see below.",
        ),
        Erratum(
            "Recursion of the variance (equation 18)",
            "v_k = v_(k-1) + (k - 1) / k (m_(k-1) - m_k)².",
            "Equation 14 gives v_k = (k - 1) / k v_(k-1) + (k - 1) (m_k - m_(k-1))². The printed "
            "one settles at a random value of mean .64 and standard deviation .41.",
        ),
        Erratum(
            "Start-up",
            "Nothing is said.",
            "With the variance estimated, the second sample alarms with probability .1825. Ten "
            "samples are not tested here; a known noise does better.",
        ),
        Erratum(
            "Alternative of the test (equation 17)",
            "The statistic is k m² / (2 v) since the first sample.",
            "That tests a shift that was there since the start: the delay grows with the root of "
            "the time before the attack, 52, 109 and 199 s for 200, 1000 and 3600 s.",
        ),
        Erratum(
            "Compensation (equations 28 to 31)",
            "zeta = ln(K1 E / r) is added with every sample and speeds the test up.",
            "E is the squared mean, which shrinks: zeta is negative and its sum -1117 after 200 s. "
            "To the letter the test does not alarm within any time that matters: the sum must "
            "first be made up for. Taken from the current sample and held at zero "
            "from below it gives the printed 17.5 s: that is `improved-sprt`, a cumulative sum of "
            "ln z². For shifts below 1.2 standard deviations it is slower than the classic test "
            "at the same false alarms.",
        ),
        Erratum(
            "False alarms",
            "alpha = 1e-5.",
            "Wald's threshold bounds the false alarms of a test that ends. Of these, which go on, "
            "in an hour: classic 8.6e-5, improved .009, likelihood ratio over windows .034.",
        ),
        Erratum(
            "All satellites spoofed",
            "Five of five spoofed satellites are detected.",
            "Moved alike they are a clock error: harmless, and seen only where the clock is known. "
            "Moved coherently, with an INS that follows, only DME sees them.",
        ),
        Erratum(
            "White noise",
            "Pseudoranges have white noise without bias.",
            "With a memory of .9 from second to second every test alarms within the hour. Samples "
            "are whitened, or refused.",
        ),
        Erratum(
            "Figures 5 and 6",
            "One simulation.",
            "The delays of Figure 5 take 2.6 to 4.8 m of noise, RAIM in Figure 6 takes 10 m.",
        ),
        Erratum(
            "Figure 4",
            "The share found falls with the number of spoofed satellites.",
            "No model of the feedback that was tried gives that order.",
        ),
    )
