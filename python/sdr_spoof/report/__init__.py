"""Report: the verdict as a self-contained HTML file and in the terminal."""

from sdr_spoof.report.figures.truth import TruthMark
from sdr_spoof.report.html import write_report
from sdr_spoof.report.spectrum import Spectrum, estimate_spectrum
from sdr_spoof.report.terminal import print_verdict

__all__ = ["Spectrum", "TruthMark", "estimate_spectrum", "print_verdict", "write_report"]
