"""Long measurements behind docs/validation.md, run by ``sdr-spoof validate``."""
