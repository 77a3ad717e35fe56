"""The benchmark measures every stage; how fast is not asserted."""

from __future__ import annotations

import pytest

from sdr_spoof import bench
from sdr_spoof.errors import SdrSpoofError


def test_every_stage_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "_BLOCK_S", 0.02)
    monkeypatch.setattr(bench, "thread_counts", lambda: [1])
    calls: list[tuple[float, float]] = []
    results = bench.run(repeats=2, progress=lambda done, total: calls.append((done, total)))
    assert [m.stage for m in results] == ["synth", "acquire", "correlate"]
    # Five satellites: B1I, B1C data and pilot made, B1I and pilot tracked.
    assert [m.channels for m in results] == [15, 8, 10]
    assert calls == [(1, 3), (2, 3), (3, 3)]
    for m in results:
        assert 0 < m.lowest_msps <= m.median_msps <= m.highest_msps
        assert m.per_channel_core_msps == pytest.approx(m.median_msps * m.channels)
        assert m.times_real_time == pytest.approx(m.median_msps / 120)


def test_correlation_is_not_measured_on_silence(monkeypatch: pytest.MonkeyPatch) -> None:
    """Channels that never track end in an error, not in a rate."""
    monkeypatch.setattr(bench, "_BLOCK_S", 0.02)
    monkeypatch.setattr(bench, "_SETTLE_S", 0.06)
    monkeypatch.setattr(bench, "thread_counts", lambda: [1])
    with pytest.raises(SdrSpoofError, match="not tracked"):
        bench.run(repeats=1)


def test_the_machine_is_named() -> None:
    here = bench.machine()
    assert here.processor
    assert here.cores >= 1
