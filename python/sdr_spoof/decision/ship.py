"""Makes the table of thresholds that comes along: ``python -m sdr_spoof.decision.ship``.

To be run again after every change of a rule, of its parameters or of the simulation.
"""

from __future__ import annotations

import json
from pathlib import Path

from sdr_spoof.decision import RULES, calibration, threshold_cache


def main() -> None:
    """Simulate all of them anew and write the table."""
    rows = calibration.LONGEST
    table = {
        calibration.key_of(rule, rows): [round(v, 4) for v in calibration.simulated(rule, rows)]
        for rule in RULES.values()
        if rule.name != "improved-sprt-as-printed"
    }
    path = Path(__file__).parent / "data" / "thresholds.json"
    kept = {"version": threshold_cache.VERSION, "thresholds": table}
    path.write_text(json.dumps(kept, indent=1) + "\n")


if __name__ == "__main__":
    main()
