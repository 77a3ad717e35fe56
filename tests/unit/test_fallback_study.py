"""The sideband that is left after an alarm keeps to the truth."""

from __future__ import annotations

import pytest

from sdr_spoof.studies.fallback import PAIRS, measure


@pytest.mark.parametrize("captured", PAIRS, ids=lambda pair: pair[0])
def test_what_is_left_stays_with_the_truth(captured: tuple[str, str, str]) -> None:
    found = measure(captured, "coherent", 45.0, 1)
    assert found.fell_back == 1
    assert 0.0 < found.alarm_s < 2.0
    # 49 s of loops of 10 and 1 Hz: 980 and 98 independent errors, 4 standard errors.
    assert found.phase_cycles == pytest.approx(found.phase_expected_cycles, rel=0.15)
    assert found.code_m == pytest.approx(found.code_expected_m, rel=0.35)
    assert found.largest_second_cycles < 0.01
