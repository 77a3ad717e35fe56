"""The root finder of thresholds."""

import math

import pytest

from sdr_spoof.root import root


def test_roots_of_smooth_functions():
    assert root(lambda x: x * x - 2.0, 0.0, 2.0, 1e-12) == pytest.approx(math.sqrt(2.0), abs=1e-12)
    assert root(lambda x: math.log(x) + 700.0, 1e-305, 1.0, 1e-310) == pytest.approx(
        math.exp(-700.0), rel=1e-6
    )
    assert root(lambda x: 3.0 - x, -1e6, 1e6, 1e-9) == pytest.approx(3.0, abs=1e-9)


def test_a_root_at_an_end_is_found():
    assert root(lambda x: x, 0.0, 5.0, 1e-9) == 0.0
    assert root(lambda x: x - 5.0, 0.0, 5.0, 1e-9) == 5.0


def test_it_needs_few_steps():
    calls = []

    def tail(z: float) -> float:
        calls.append(z)
        return math.log(math.erfc(z / math.sqrt(2.0)) * z) + 20.0

    assert tail(root(tail, 2.0, 30.0, 1e-12)) == pytest.approx(0.0, abs=1e-9)
    assert len(calls) < 30


def test_without_a_change_of_sign_it_says_so():
    with pytest.raises(ValueError, match="no change of sign between 1 and 2"):
        root(lambda x: x, 1.0, 2.0, 1e-9)
