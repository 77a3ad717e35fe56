"""Small skies."""

from typing import Any

from sdr_spoof.scenario import Scenario, SkySatellite

PLACE = {"kind": "static", "latitude_deg": 31.2, "longitude_deg": 121.5, "height_m": 30.0}
RECORDING = {
    "duration_s": 4.0,
    "sample_rate_hz": 25e6,
    "lo_hz": 1568.259e6,
    "sample_format": "ci8",
}
VACUUM = {"ionosphere": "none", "troposphere": "none"}
CIRCLE = PLACE | {"kind": "circle", "radius_m": 91.8, "speed_m_s": 30.0}


def sky(
    receiver: dict[str, Any] | None = None,
    recording: dict[str, Any] | None = None,
    attack: dict[str, Any] | None = None,
    **table: Any,
) -> Scenario:
    """A scenario of satellites on their orbits."""
    given = {"start": "2023-03-12T12:00:00", "receiver": receiver or PLACE} | VACUUM | table
    return Scenario.model_validate(
        {
            "recording": RECORDING | (recording or {}),
            "sky": given,
            "attack": [attack] if attack else [],
        }
    )


def satellite(made: Scenario, system: str, prn: int) -> SkySatellite:
    found = next(s for s in made.satellites if (s.system, s.prn) == (system, prn))
    assert isinstance(found, SkySatellite)
    return found
