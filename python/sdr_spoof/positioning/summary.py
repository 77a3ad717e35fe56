"""What positioning found, in a few numbers, for ``--json``, terminal and report."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.fixes import Status
from sdr_spoof.route import Quality
from sdr_spoof.signals import satellite_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sdr_spoof.nav.broadcast import Contents

    from .located import Located


@dataclass(frozen=True)
class Summary:
    """Medians over all fixes; None without one."""

    epochs: int
    fixes: int
    suspect: int
    """Fixes that contradict themselves, or rest on satellites under suspicion while others are
    spoofed; they are not in the medians."""
    unchecked: int
    """Fixes that nothing confirms: no satellite more than needed, or time, place and orbits from
    the user alone."""
    first_fix_s: float | None
    """Time of the first fix since the first sample."""
    first_fix_utc: str | None
    latitude_deg: float | None
    longitude_deg: float | None
    height_m: float | None
    """Above the WGS-84 ellipsoid."""
    speed_m_s: float | None
    hdop: float | None
    satellites: tuple[str, ...]
    """Used in any fix."""
    left_out: tuple[str, ...]
    """Spoofed satellites that no fix used from their onset on."""
    integrity: tuple[Judged, ...]
    """How geostationary BDS satellites judged others last."""
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Judged:
    """The last that was said of a satellite; None where nothing is, or no limit."""

    satellite: str
    usable: bool
    udre_m: float | None
    rura_m: float | None
    correction_m: float | None


def _judged(navigation: Contents) -> tuple[Judged, ...]:
    def known(value: float) -> float | None:
        return value if math.isfinite(value) else None

    last = {satellite_name(i.system, i.prn): i for i in navigation.integrity or ()}
    return tuple(
        Judged(name, i.usable, known(i.udre_m), known(i.rura_m), known(i.correction_m))
        for name, i in sorted(last.items())
    )


def summarise(found: Located) -> Summary:
    """Numbers of a located recording."""
    fixes, route = found.fixes, found.route
    rows = np.flatnonzero(fixes.fixed)
    good = np.flatnonzero(route.quality == Quality.FIX)

    def middle(values: np.ndarray) -> float | None:
        kept = values[good][np.isfinite(values[good])]
        return float(np.median(kept)) if kept.size else None

    first = int(rows[0]) if rows.size else None
    return Summary(
        epochs=fixes.epochs,
        fixes=int(rows.size),
        suspect=int(rows.size - good.size),
        unchecked=int((fixes.status[good] == Status.UNCHECKED).sum()),
        first_fix_s=None if first is None else float(route.sample_time_s[first]),
        first_fix_utc=None
        if first is None
        else route.times[first].utc().isoformat(timespec="milliseconds"),
        latitude_deg=middle(route.latitude_deg),
        longitude_deg=middle(route.longitude_deg),
        height_m=middle(route.height_m),
        speed_m_s=middle(np.hypot(*route.velocity_enu_m_s[:, :2].T)),
        hdop=middle(route.dop[:, 1]),
        satellites=tuple(s.name for s in route.satellites if s.used.any()),
        left_out=tuple(
            dict.fromkeys(name for epoch in range(fixes.epochs) for name in fixes.spoofed(epoch))
        ),
        integrity=_judged(found.navigation),
        notes=found.notes,
    )


def sentences(summary: Summary) -> Iterator[str]:
    """The same in words."""
    if not summary.fixes:
        yield "No position: " + (summary.notes[-1] if summary.notes else "nothing was observed")
        return
    if summary.latitude_deg is not None and summary.longitude_deg is not None:
        north = f"{abs(summary.latitude_deg):.6f}° {'NS'[summary.latitude_deg < 0]}"
        east = f"{abs(summary.longitude_deg):.6f}° {'EW'[summary.longitude_deg < 0]}"
        yield f"Position: {north}, {east}, {summary.height_m:.1f} m above the ellipsoid (median)"
    yield (
        f"{summary.fixes} fixes in {summary.epochs} epochs, the first after "
        f"{summary.first_fix_s:.1f} s, at {summary.first_fix_utc}"
    )
    if summary.suspect:
        yield (
            f"{summary.suspect} of them are not to be trusted: they contradict themselves, or rest "
            "on satellites under suspicion while others are spoofed"
        )
    if summary.unchecked:
        yield (f"{summary.unchecked} of them are unchecked: nothing would show if they were wrong")
    if summary.left_out:
        yield f"Left out as spoofed: {', '.join(summary.left_out)}"
    bad = [j.satellite for j in summary.integrity if not j.usable]
    if bad:
        yield f"Not to be used, by the integrity message of BDS: {', '.join(bad)}"
