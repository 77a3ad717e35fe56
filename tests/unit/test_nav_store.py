"""Which ephemeris is taken: the closest, the newest, and what speaks against it."""

from dataclasses import replace

import numpy as np
import pytest
from nav_air import KLOBUCHAR, NOON, air, navigation

from sdr_spoof.nav.broadcast import Bdgim, Contents
from sdr_spoof.nav.frames import decode_runs
from sdr_spoof.nav.plausible import objection
from sdr_spoof.nav.store import Store, conflicts
from sdr_spoof.nav.time import GnssTime

HOUR = GnssTime.of_week(897, 12 * 3600, "C")


def _ephemeris(prn=27, toe=HOUR, **more):
    e = next(e for e in navigation().ephemerides if (e.system, e.prn) == ("C", prn))
    return replace(e, **({"toe": toe, "toc": toe, "transmitted": toe} | more))


def test_the_closest_reference_is_taken() -> None:
    first, second = _ephemeris(), _ephemeris(toe=HOUR + 3600.0)
    store = Store(Contents(ephemerides=(second, first)))
    for minutes, expected in ((-50, first), (10, first), (29, first), (31, second), (300, second)):
        found = store.select("C", 27, HOUR + 60.0 * minutes)
        assert found is not None
        assert found.ephemeris is expected
        assert found.stale == (minutes == 300)
        assert found.healthy
    assert store.select("C", 27, HOUR + 60.0).age_s == 60.0
    assert store.select("C", 30, HOUR) is None
    assert store.select("G", 27, HOUR) is None
    assert store.satellites() == [("C", 27)]


def test_delay_of_b1c_is_that_of_b1i_where_none_is_stated() -> None:
    d1 = _ephemeris(prn=23)
    assert d1.group_delay_s("B1I") == pytest.approx(22.7e-9)
    assert d1.group_delay_s("B1CP") == d1.group_delay_s("B1CD") == d1.group_delay_s("B1I")
    assert d1.group_delay_s("L1CA") == 0.0
    # What C23 says itself in tests/vectors/messages, ten months later.
    own = replace(d1, message="CNV1", group_delays_s=(("B1CP", 23.5e-9), ("B1CD", 22.4e-9)))
    assert own.group_delay_s("B1CP") == 23.5e-9
    assert own.group_delay_s("B1I") == 0.0


def test_of_equals_the_one_sent_last_is_taken() -> None:
    old = _ephemeris(transmitted=HOUR + -3000.0)
    new = _ephemeris(transmitted=HOUR + -600.0, e=0.001)
    for order in ((old, new), (new, old)):
        store = Store(Contents(ephemerides=order))
        assert store.select("C", 27, HOUR).ephemeris is new
    # The recording takes precedence over a file where both have the same.
    file, recording = Contents((old,)), Contents((replace(old, e=0.002),))
    assert Store(file, recording).select("C", 27, HOUR).ephemeris.e == 0.002


def test_messages_can_be_chosen() -> None:
    d1, modern = _ephemeris(), _ephemeris(message="CNV1", transmitted=HOUR + 60.0)
    store = Store(Contents((d1, modern)))
    assert store.select("C", 27, HOUR).ephemeris is modern
    assert store.select("C", 27, HOUR, ["D1", "D2"]).ephemeris is d1
    assert store.select("C", 27, HOUR, ["LNAV"]) is None
    assert set(store.all_at(HOUR, ["D1"])) == {("C", 27)}
    assert store.all_at(HOUR, ["LNAV"]) == {}


def test_unhealthy_satellites_are_told() -> None:
    well, ill = _ephemeris(), _ephemeris(health=1, transmitted=HOUR + 1800.0, toe=HOUR + 3600.0)
    store = Store(Contents((well, ill)))
    assert store.select("C", 27, HOUR).healthy
    # Set unhealthy before the new reference: the old orbit may not be used either.
    assert not store.select("C", 27, HOUR + 1799.0 + 2.0).healthy
    by_page = Store(Contents((well,), health=(("C27", 0x100), ("C28", 0))))
    assert not by_page.select("C", 27, HOUR).healthy
    recovered = Store(Contents((well,), health=(("C27", 1),)), Contents(health=(("C27", 0),)))
    assert recovered.select("C", 27, HOUR).healthy


def test_models_are_those_sent_closest() -> None:
    early = replace(KLOBUCHAR["C"], transmitted=HOUR)
    late = replace(KLOBUCHAR["C"], transmitted=HOUR + 7200.0, alpha=(0.0, 0.0, 0.0, 0.0))
    bdgim = Bdgim((1.0,) * 9, "C", HOUR)
    store = Store(Contents(ionosphere=(KLOBUCHAR["G"], early, late, bdgim)))
    assert store.klobuchar("C", HOUR + 60.0) is early
    assert store.klobuchar("C", HOUR + 7000.0) is late
    assert store.klobuchar("G", HOUR) is KLOBUCHAR["G"]
    assert store.bdgim(HOUR) is bdgim
    assert Store().klobuchar("C", HOUR) is None
    assert Store(navigation()).utc("G", NOON).leap_s == 18
    assert Store(navigation()).utc("C", NOON) is None


def test_a_forged_ephemeris_shows_against_the_file() -> None:
    run = air("D1", 27, GnssTime.of_week(897, 43_500, "C"), 36.5)
    received = decode_runs([run])
    assert conflicts(navigation(), received) == []
    (e,) = received.ephemerides
    forged = Contents((replace(e, m0=e.m0 + 1e-5, a0=e.a0 + 1e-6),))
    (told,) = conflicts(navigation(), forged)
    assert told.startswith("C27 D1 issue")
    assert told.endswith("differs in a0, m0")


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"e": 0.7}, "e is 0.7"),
        ({"a": 1e7}, "a is 1e"),
        ({"a0": np.inf}, "a0 is inf"),
        ({"toc": HOUR + 400_000.0}, "hours apart"),
    ],
)
def test_impossible_ephemerides(change, told) -> None:
    assert objection(_ephemeris()) is None
    assert told in objection(replace(_ephemeris(), **change)).replace(" h ", " hours ")
