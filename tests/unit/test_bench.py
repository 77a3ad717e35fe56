"""The benchmark measures every stage; how fast is not asserted."""

from __future__ import annotations

import pytest

from sdr_spoof import bench


def test_every_stage_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "_DURATION_S", 0.1)
    monkeypatch.setattr(bench, "_SYNTH_S", 0.01)
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
