"""RINEX navigation files 3.05 and 4.00 of what was received.

Sources: RINEX 3.05 (appendix A4 to A14) and 4.00 (section 5). Files carry no dates of their making:
the same contents give the same bytes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import rinex_orbits
from .broadcast import Bdgim, Klobuchar
from .ephemeris import CNAV1
from .rinex_lines import line, written, written_epoch
from .rinex_offsets import SYSTEMS as OFFSET_CODES
from .time import WEEK_S, GnssTime

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .broadcast import Contents, Ionosphere, TimeOffset, UtcParameters
    from .ephemeris import Ephemeris

VERSIONS = ("3.05", "4.00")
PROGRAM = "sdr-spoof"
IONOSPHERE = {"G": "GPS", "C": "BDS"}
CODES = {system: code for code, system in OFFSET_CODES.items()}
MESSAGE_OF_MODEL = {"G": "LNAV", "C": "D1D2"}
UTC_NAMES = {"G": "UTC(USNO)", "C": "UTC(NTSC)"}


def format_navigation(contents: Contents, version: str = "4.00") -> str:
    """Text of a file; version 3.05 has no place for B-CNAV1 and BDGIM, which are left out.

    Raises:
        ValueError: for another version.
    """
    if version not in VERSIONS:
        raise ValueError(f"version is {version}, must be one of {', '.join(VERSIONS)}")
    newest = version == "4.00"
    lines = [*_header(contents, version), _labelled("", "END OF HEADER")]
    if newest:
        lines += [text for u in contents.utc for text in _offset(u)]
        lines += [text for o in contents.offsets for text in _offset(o)]
        lines += [text for i in contents.ionosphere for text in _ionosphere(i)]
    order = sorted(contents.ephemerides, key=lambda e: (e.system, e.prn, e.toc, e.transmitted))
    for e in order:
        if newest:
            lines.append(f"> EPH {e.system}{e.prn:02d} {e.message}")
        if newest or e.message != CNAV1:
            lines += _ephemeris(e)
    return "\n".join(lines) + "\n"


def _labelled(text: str, label: str) -> str:
    return f"{text:<60}{label:<20}"


def _header(contents: Contents, version: str) -> list[str]:
    systems = {e.system for e in contents.ephemerides}
    system = systems.pop() if len(systems) == 1 else "M"
    kind = f"{version:>9}{'':11}{'NAVIGATION DATA':<20}{system:<20}"
    lines = [
        _labelled(kind, "RINEX VERSION / TYPE"),
        _labelled(f"{PROGRAM:<20}", "PGM / RUN BY / DATE"),
    ]
    if version != "4.00":
        lines += [text for i in _latest(contents.ionosphere) for text in _ionosphere_3(i)]
        lines += [_labelled(_offset_3(u), "TIME SYSTEM CORR") for u in _latest(contents.utc)]
    for utc in _latest(contents.utc)[:1]:
        leap = f"{utc.leap_s:6d}{utc.leap_future_s:6d}{utc.leap_week:6d}{utc.leap_day:6d}"
        lines.append(_labelled(leap + ("BDS" if utc.system == "C" else ""), "LEAP SECONDS"))
    return lines


def _latest(items: Iterable[Any]) -> list[Any]:
    """The last sent of each kind and system: headers of version 3 have room for one."""
    last: dict[tuple[type, str], Any] = {}
    for item in items:
        key = type(item), item.system
        if key not in last or _order(item) >= _order(last[key]):
            last[key] = item
    return list(last.values())


def _order(item: Any) -> int:
    return 0 if item.transmitted is None else int(item.transmitted.seconds)


def _ionosphere_3(model: Ionosphere) -> list[str]:
    if not isinstance(model, Klobuchar):
        return []
    lines = []
    for letter, values in (("A", model.alpha), ("B", model.beta)):
        numbers = "".join(f"{v:12.4E}" for v in values)
        text = f"{IONOSPHERE[model.system]}{letter} {numbers}"
        lines.append(_labelled(text, "IONOSPHERIC CORR"))
    return lines


def _offset_3(utc: UtcParameters) -> str:
    week, tow = utc.reference.week_tow(utc.system)
    polynomial = f"{utc.a0:17.10E}{utc.a1:16.9E}"
    return f"{CODES[utc.system]}UT {polynomial} {round(tow):6d} {week:4d}"


def _sent(time: GnssTime | None, reference: GnssTime, system: str) -> float:
    """Second of the week of transmission."""
    return float(round((time or reference).week_tow(system)[1]) % WEEK_S)


def _offset(offset: UtcParameters | TimeOffset) -> list[str]:
    system = offset.system
    other = getattr(offset, "other", None)
    code = CODES[system] + ("UT" if other is None else CODES[other])
    name = "" if other is not None else UTC_NAMES[system]
    when = written_epoch(offset.reference, system)
    sent = _sent(offset.transmitted, offset.reference, system)
    return [
        f"> STO {system}{1:02d} {MESSAGE_OF_MODEL[system]}",
        f"    {when} {code:<18} {'':18} {name:<18}".rstrip(),
        line([sent, offset.a0, offset.a1, offset.a2]),
    ]


def _ionosphere(model: Ionosphere) -> list[str]:
    time = model.transmitted or GnssTime(0)
    when = written_epoch(time, model.system)
    if isinstance(model, Bdgim):
        values, message = list(model.alpha), "CNVX"
    else:
        values, message = [*model.alpha, *model.beta], MESSAGE_OF_MODEL[model.system]
    return [
        f"> ION {model.system}{1:02d} {message}",
        f"    {when}" + "".join(written(v) for v in values[:3]),
        line(values[3:7]),
        line(values[7:]),
    ]


def _ephemeris(e: Ephemeris) -> list[str]:
    fields = rinex_orbits.fields(e)
    clock = "".join(written(v) for v in (e.a0, e.a1, e.a2))
    lines = [f"{e.system}{e.prn:02d} {written_epoch(e.toc, e.system)}{clock}"]
    for names in rinex_orbits.LINES[e.message]:
        values = [fields.get(n, 0.0) if n else 0.0 for n in names]
        lines.append(line(values))
    return lines
