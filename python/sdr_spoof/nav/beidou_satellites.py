"""Which BDS satellites stand where."""

GEO = frozenset({1, 2, 3, 4, 5, 59, 60, 61, 62, 63})
"""Geostationary ones: they send D2, all others to 63 send D1 (BDS-SIS-ICD-B1I-3.0, table 4-1)."""
NOT_GEO = frozenset(range(1, 64)) - GEO
