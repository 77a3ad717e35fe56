"""Navigation and observations in a result file: read back as they were, the same bytes twice."""

from __future__ import annotations

from dataclasses import fields, replace

import h5py
import numpy as np
import pytest
from observed_tracks import START, Moving, navigation, observed_log

from sdr_spoof.nav.broadcast import Bdgim, Klobuchar, UtcParameters
from sdr_spoof.nav.ephemeris import Ephemeris
from sdr_spoof.observables import observe
from sdr_spoof.sinks.hdf5 import Result, read_result, write_result
from sdr_spoof.sources import RecordingFormat

SKY = (Moving(27), Moving(30, 0.0711, -3000.0))


def ephemeris(prn, **more):
    numbers = {f.name: 0.1 * i for i, f in enumerate(fields(Ephemeris)) if f.type == "float"}
    return Ephemeris(
        system="C", prn=prn, message="D1", toe=START, toc=START + 1.0, transmitted=START + 0.3,
        iode=1, iodc=2, health=0, group_delays_s=(("B1I", 1e-9), ("B1CP", -2e-9)),
        **(numbers | more),
    )  # fmt: skip


@pytest.fixture
def result():
    told = replace(
        navigation(*SKY),
        ephemerides=(ephemeris(27), ephemeris(30, accuracy_m=float("nan"))),
        ionosphere=(
            Klobuchar((1.0, 2.0, 3.0, 4.0), (5.0, 6.0, 7.0, 8.0), "C"),
            Bdgim(tuple(float(i) for i in range(9)), transmitted=START),
        ),
        utc=(UtcParameters("C", 1e-9, 0.0, START, 4, 1, 2, 4),),
        health=(("C27", 0), ("C30", 1)),
        notes=("one", "two"),
    )
    seen = observe(observed_log(*SKY), told)
    form = RecordingFormat(sample_format="ri8", sample_rate_hz=25e6, lo_hz=1.55e9)
    return Result("rec", form, {}, navigation=told, observations=seen)


def assert_same(a, b):
    if isinstance(a, np.ndarray):
        assert a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
    elif isinstance(a, tuple) and a:
        assert len(a) == len(b)
        for x, y in zip(a, b, strict=True):
            assert_same(x, y)
    elif hasattr(a, "__dataclass_fields__"):
        assert type(a) is type(b)
        for field in fields(a):
            assert_same(getattr(a, field.name), getattr(b, field.name))
    else:
        assert a == b or (np.isnan(a) and np.isnan(b))


def test_round_trip(result, tmp_path):
    path = tmp_path / "r.h5"
    write_result(path, result)
    back = read_result(path)
    assert_same(result.navigation, back.navigation)
    assert_same(result.observations, back.observations)


def test_same_bytes(result, tmp_path):
    for name in "ab":
        write_result(tmp_path / name, result)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_every_dataset_has_units(result, tmp_path):
    write_result(tmp_path / "r.h5", result)
    with h5py.File(tmp_path / "r.h5") as file:
        units = {}
        file.visititems(
            lambda name, item: (
                units.update({name: item.attrs["units"]})
                if isinstance(item, h5py.Dataset)
                else None
            )
        )
    assert units["observations/pseudorange_m"] == "m"
    assert units["observations/doppler_hz"] == "Hz"
    assert units["navigation/ephemerides/00_Ephemeris/toe"] == "s"


def test_without_navigation(result, tmp_path):
    write_result(tmp_path / "r.h5", replace(result, navigation=None, observations=None))
    back = read_result(tmp_path / "r.h5")
    assert back.navigation is None and back.observations is None
