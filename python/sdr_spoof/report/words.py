"""The verdict in plain words, shared by the HTML report and the terminal."""

from __future__ import annotations

from sdr_spoof import _core, detectors, signals
from sdr_spoof.detectors import power
from sdr_spoof.detectors.series import LOG10_P_FLOOR
from sdr_spoof.fusion import evidence_of
from sdr_spoof.records import Alarm, SatelliteVerdict, Verdict
from sdr_spoof.verdict import CLEAN, NO_SUPPORT, SPOOFED, SUSPECT

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
        "suspect": "Suspicious signals",
        "clean": "No spoofing found",
        "unsupported": "Not enough support for a verdict",
    }[level(verdict)]


def level(verdict: Verdict) -> str:
    """'spoofed', 'suspect', 'clean' or 'unsupported', for colours and icons."""
    if verdict.spoofed:
        return "spoofed"
    if verdict.suspect:
        return "suspect"
    return "clean" if has_support(verdict) else "unsupported"


def has_support(verdict: Verdict) -> bool:
    """Whether at least one satellite could be tested."""
    return any(s.verdict != NO_SUPPORT for s in verdict.satellites)


def alarm_sentence(alarm: Alarm) -> str:
    """Satellite, band and time of an alarm."""
    who = satellite_name(alarm.system, alarm.prn)
    return f"{who}: {_what(alarm)}, since {alarm.onset_s:.2f} s."


def _what(alarm: Alarm) -> str:
    band = band_name(alarm.band)
    if evidence_of(alarm.detector) == "quality":
        if alarm.detector == power.NAME:
            return f"{alarm.quantity} of its {band} signal rose; multipath or a spoofer"
        return f"the correlation peak of its {band} signal changed shape; multipath or a spoofer"
    thing = "code" if alarm.detector.startswith("code") else "carrier"
    if alarm.band is not None:
        return f"its {band} {thing} left its course"
    return f"the {thing}s of its two bands no longer move together; which one left is unclear"


def leading_alarms(verdict: Verdict) -> list[Alarm]:
    """What the verdict rests on: the first alarm of each spoofed or suspect satellite, and all
    others of consistency."""
    return [
        alarm
        for s in ordered(verdict)
        for k, alarm in enumerate(s.alarms)
        if k == 0 or evidence_of(alarm.detector) == "consistency"
    ]


def action_sentence(satellite: SatelliteVerdict) -> str:
    """Which band was captured, how sure that is, and what to do."""
    who = satellite_name(satellite.system, satellite.prn)
    if satellite.band is None:
        return f"{who}: which band was captured cannot be told; {satellite.action}."
    sure = f", {satellite.band_confidence:.1%} sure" if satellite.band_confidence else ""
    return f"{who}: captured is {band_name(satellite.band)}{sure}; {satellite.action}."


def figure_title(alarm: Alarm) -> str:
    """Heading of the figure of an alarm."""
    who = satellite_name(alarm.system, alarm.prn)
    if alarm.detector.startswith("phase_difference"):
        return f"{who}: the two carriers part"
    of = f" of {band_name(alarm.band)}" if alarm.band else ""
    quantity = f" ({alarm.quantity})" if alarm.quantity else ""
    return f"{who}: {detectors.find(alarm.detector).title}{quantity}{of}"


def figure_note(alarm: Alarm) -> str:
    """What the figure of an alarm shows."""
    if alarm.detector.startswith("phase_difference"):
        return (
            "Both carriers of a satellite come from one clock. Scaled to one frequency, their "
            "phase difference stands still; a spoofer who drags one of them away turns it. Gaps: "
            "a loop had lost lock; the phase goes on where it ended."
        )
    return f"It tests {detectors.find(alarm.detector).tests}. Shaded: what noise does."


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
    rank = {SPOOFED: 0, SUSPECT: 1, CLEAN: 2, NO_SUPPORT: 3}
    return sorted(verdict.satellites, key=lambda s: (rank[s.verdict], s.system, s.prn))


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
