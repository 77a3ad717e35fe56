"""User range accuracy: index in the message, metres in records.

IS-GPS-200, 20.3.3.3.1.3 (nominal values), BDS-SIS-ICD-B1I-3.0, 5.2.4.5: 2^(1 + N/2) m up to index
6, 2^(N - 2) m above; 15: no prediction.
"""

from __future__ import annotations

import math

NO_PREDICTION = 15
METRES = tuple(round(2.0 ** (1 + n / 2), 1) if n <= 6 else 2.0 ** (n - 2) for n in range(15))


def metres(index: int) -> float:
    """Accuracy that an index means; NaN for none."""
    return math.nan if index >= NO_PREDICTION else METRES[index]


def index(accuracy_m: float) -> int:
    """Index to send: the first that is no better than the accuracy."""
    if math.isnan(accuracy_m):
        return NO_PREDICTION
    return next((n for n, m in enumerate(METRES) if accuracy_m <= m * 1.05), NO_PREDICTION)
