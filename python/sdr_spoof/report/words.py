"""The verdict in plain words, shared by the HTML report and the terminal."""

from __future__ import annotations

from sdr_spoof import _core, detectors, signals
from sdr_spoof.detectors import power, power_difference, second_peak
from sdr_spoof.detectors.series import LOG10_P_FLOOR
from sdr_spoof.fusion import BOTH_CHANGED, deciding, evidence_of
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


def satellite_sentence(satellite: SatelliteVerdict) -> str:
    """What happened to a satellite with an alarm, and since when."""
    who = satellite_name(satellite.system, satellite.prn)
    since = f", since {satellite.onset_s:.2f} s" if satellite.onset_s is not None else ""
    if satellite.verdict == SUSPECT:
        return f"{who}: {_what(satellite.alarms[0])}{since}."
    if satellite.action.endswith(BOTH_CHANGED):
        return f"{who}: spoofed in both bands{since}."
    if all(a.detector == second_peak.NAME for a in deciding(satellite.alarms)):
        return f"{who}: {second_peak.CAUSE}{since}."
    if satellite.band is None:
        return f"{who}: spoofed, in which band cannot be told{since}."
    return f"{who}: its {band_name(satellite.band)} signal has been captured{since}."


def _what(alarm: Alarm) -> str:
    if evidence_of(alarm.detector) == "consistency":
        return "carriers or codes parted, and its peaks changed with them, as a reflection does too"
    if alarm.detector == power_difference.NAME:
        return "the power of one band changed against the other's; multipath or a spoofer"
    band = band_name(alarm.band)
    if cause := detectors.common_cause(alarm):
        return f"the noise floor of {band} rose for all satellites alike; {cause}"
    if alarm.detector == power.NAME:
        return f"{alarm.quantity} of its {band} signal rose; multipath or a spoofer"
    return f"the correlation peak of its {band} signal changed shape; multipath or a spoofer"


def alarms_sentence(satellite: SatelliteVerdict) -> str:
    """The first alarm with its number, and which other tests confirm it."""
    first = min(satellite.alarms, key=_order)
    parts = [f"{_test(first)}: {evidence(first)}"]
    others: dict[str, float] = {}
    for alarm in sorted(satellite.alarms, key=_order):
        if alarm.detector != first.detector:
            others.setdefault(detectors.find(alarm.detector).title, alarm.alarm_s)
    if others:
        confirmed = ", ".join(f"{title} ({at_s:.2f} s)" for title, at_s in others.items())
        parts.append(f"alarms of other tests: {confirmed}")
    return "; ".join(parts)


def _order(alarm: Alarm) -> tuple[bool, float]:
    return evidence_of(alarm.detector) != "consistency", alarm.alarm_s


def _test(alarm: Alarm) -> str:
    """Title of an alarm's test, with what it measured on which signal."""
    title = detectors.find(alarm.detector).title
    if alarm.detector.startswith(("phase_difference", "code_difference", "power_difference")):
        return title
    composite = _core.signal_spec(alarm.band)["composite"] if alarm.band else ""
    return " ".join(filter(None, (title, alarm.quantity and f"({alarm.quantity})", composite)))


def action_sentence(satellite: SatelliteVerdict) -> str:
    """What to do with a satellite, and how sure it is which band was captured."""
    if satellite.verdict != SPOOFED:
        return satellite.action
    if satellite.action.endswith(BOTH_CHANGED):
        return satellite.action
    if satellite.band is None:
        return f"{satellite.action}: which band was captured cannot be told"
    sure = f", {_percent(satellite.band_confidence)} sure" if satellite.band_confidence else ""
    return f"{satellite.action} ({band_name(satellite.band)} is the captured one{sure})"


def _percent(probability: float) -> str:
    """Never rounded up to certainty."""
    return f"{min(probability, 0.999):.1%}" if probability < 0.999 else "more than 99.9%"


def figure_title(alarm: Alarm) -> str:
    """Heading of the figure of an alarm."""
    who = satellite_name(alarm.system, alarm.prn)
    if alarm.detector.startswith("phase_difference"):
        return f"{who}: {detectors.find(alarm.detector).title}"
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


def sureness(satellite: SatelliteVerdict) -> str:
    """How sure the verdict is, as the probability that noise raised its clearest alarm."""
    alarm = min(deciding(satellite.alarms), key=lambda a: a.log10_p)
    if alarm.log10_p <= LOG10_P_FLOOR:
        return f"noise alone does this in fewer than 1 of {_power_of_ten(-LOG10_P_FLOOR)} tests"
    return f"noise alone does this in about 1 of {_power_of_ten(-alarm.log10_p)} tests"


def _power_of_ten(exponent: float) -> str:
    digits = str(round(exponent)).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{digits}"


def times(ratio: float) -> str:
    """How many times a threshold, short."""
    return f"{ratio:.1f}×" if ratio < 10 else f"{ratio:.0f}×"


def evidence(alarm: Alarm) -> str:
    """The number behind an alarm."""
    return (
        f"{alarm.statistic:+.3f} {alarm.unit} where undisturbed signals stay within "
        f"±{alarm.threshold:.3f} {alarm.unit}; alarm raised at {alarm.alarm_s:.2f} s"
    )


def tested_sentence(verdict: Verdict, names: tuple[str, ...]) -> str:
    """How many satellites were tested, by what."""
    done = sum(s.verdict != NO_SUPPORT for s in verdict.satellites)
    if not verdict.satellites:
        return "Nothing: no satellite was received."
    if not done:
        return f"None of the {len(verdict.satellites)} satellites could be tested."
    what = ", ".join(detectors.find(name).title for name in dict.fromkeys(names))
    return f"{done} of {len(verdict.satellites)} satellites. Tests: {what}."


def tests(names: tuple[str, ...]) -> list[detectors.Detector]:
    """The tests that were made."""
    return [detectors.find(name) for name in dict.fromkeys(names)]


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
