"""Makes the table of thresholds that comes along: ``python -m sdr_spoof.decision.ship``.

To be run again after every change of a rule, of its parameters or of the simulation.
"""

from __future__ import annotations

import json
from pathlib import Path

from sdr_spoof.decision import RULES, calibration, threshold_cache
from sdr_spoof.decision.laws import NORMAL

PER_HOUR = (1e-2, 1e-3, 1e-4)
"""Probabilities for which every rule has a threshold, at one sample a second."""


def main() -> None:
    """Simulate all of them anew and write the table."""
    table = {
        calibration.key_of(rule, per_hour, 1.0, NORMAL): calibration.simulated(rule, per_hour)
        for rule in RULES.values()
        if rule.name != "improved-sprt-as-printed"
        for per_hour in PER_HOUR
    }
    path = Path(__file__).parent / "data" / "thresholds.json"
    kept = {"version": threshold_cache.VERSION, "thresholds": table}
    path.write_text(json.dumps(kept, indent=1) + "\n")


if __name__ == "__main__":
    main()
