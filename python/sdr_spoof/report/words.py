"""The verdict in plain words, shared by the HTML report and the terminal."""

from __future__ import annotations

from sdr_spoof import _core, detectors, signals
from sdr_spoof.detectors.series import LOG10_P_FLOOR
from sdr_spoof.records import Alarm, SatelliteVerdict, Verdict
from sdr_spoof.verdict import NO_SUPPORT, SPOOFED

satellite_name = signals.satellite_name


def band_name(signal: str | None) -> str:
    """A signal's band as users know it, e.g. 'B1C (1575.42 MHz)'."""
    if signal is None:
        return "band not told apart"
    spec = _core.signal_spec(signal)
    return f"{spec['composite']} ({spec['carrier_hz'] / 1e6:.7g} MHz)"


def headline(verdict: Verdict) -> str:
    """The answer in two or three words."""
    return {
        "spoofed": "Spoofing detected",
        "clean": "No spoofing found",
        "unsupported": "Not enough support for a verdict",
    }[level(verdict)]


def level(verdict: Verdict) -> str:
    """'spoofed', 'clean' or 'unsupported', for colours and icons."""
    if verdict.spoofed:
        return "spoofed"
    return "clean" if has_support(verdict) else "unsupported"


def has_support(verdict: Verdict) -> bool:
    """Whether at least one satellite could be tested."""
    return any(s.verdict != NO_SUPPORT for s in verdict.satellites)


def alarm_sentence(alarm: Alarm) -> str:
    """Satellite, band and time of an alarm."""
    who = satellite_name(alarm.system, alarm.prn)
    if alarm.band is None:
        what = "the carriers of its two bands no longer move together; which one left is unclear"
    else:
        what = f"its {band_name(alarm.band)} carrier left its course"
    return f"{who}: {what}, since {alarm.onset_s:.2f} s."


def sureness(alarm: Alarm) -> str:
    """How sure the alarm is, as the probability that noise did it."""
    if alarm.log10_p <= LOG10_P_FLOOR:
        return f"noise alone does this in fewer than 1 of {_power_of_ten(-LOG10_P_FLOOR)} tests"
    return f"noise alone does this in about 1 of {_power_of_ten(-alarm.log10_p)} tests"


def _power_of_ten(exponent: float) -> str:
    digits = str(round(exponent)).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{digits}"


def evidence(alarm: Alarm) -> str:
    """The number behind an alarm."""
    return (
        f"{alarm.statistic:+.3f} {alarm.unit} where undisturbed signals stay within "
        f"±{alarm.threshold:.3f} {alarm.unit}; alarm raised at {alarm.alarm_s:.2f} s"
    )


def tested_sentence(verdict: Verdict, names: tuple[str, ...]) -> str:
    """What was tested, on how many satellites."""
    done = sum(s.verdict != NO_SUPPORT for s in verdict.satellites)
    what = "; ".join(detectors.find(name).tests for name in names)
    if not verdict.satellites:
        return "Nothing: no satellite was received."
    if not done:
        return f"None of the {len(verdict.satellites)} satellites could be tested for {what}."
    return f"On {done} of {len(verdict.satellites)} satellites: {what}."


def ordered(verdict: Verdict) -> list[SatelliteVerdict]:
    """Satellites with the worst news first, then by name."""
    rank = {SPOOFED: 0, NO_SUPPORT: 2}
    return sorted(verdict.satellites, key=lambda s: (rank.get(s.verdict, 1), s.system, s.prn))


def rows(verdict: Verdict) -> list[tuple[str, SatelliteVerdict]]:
    """(names, verdict) for tables: satellites that cannot be tested for one reason share a row."""
    groups: dict[object, list[SatelliteVerdict]] = {}
    for s in ordered(verdict):
        key = s.reason if s.verdict == NO_SUPPORT else (s.system, s.prn)
        groups.setdefault(key, []).append(s)
    return [(" ".join(satellite_name(s.system, s.prn) for s in g), g[0]) for g in groups.values()]


def name_of(signal: str, prn: int) -> str:
    """RINEX satellite name of a signal's transmitter."""
    return satellite_name(str(_core.signal_spec(signal)["system"]), prn)
