"""What every registered signal must satisfy; an opt-out is listed with its reason."""

from __future__ import annotations

import csv
import itertools
from pathlib import Path

import numpy as np
import pytest

from sdr_spoof import _core
from sdr_spoof.errors import SignalError
from sdr_spoof.signals import components, signal_ids, signal_spec

VECTORS = Path(__file__).parents[1] / "vectors" / "icd"
SIGNALS = signal_ids()

NO_OVERLAY = {
    "B1CD": "the ICD gives only the pilot a secondary code",
    "L1CA": "a data bit lasts 20 plain code periods",
}
"""Signals excused from the secondary-code test, with the reason."""

UNBALANCED = {
    "E5AQ": "cut off from longer sequences: 1s and 0s differ by as much as those of random codes",
    "E5BQ": "as E5AQ",
}
"""Signals excused from equal numbers of 0s and 1s, with the reason."""

VECTORS_OF = {
    "B1I": "b1i.csv",
    "B1CD": "b1c.csv",
    "B1CP": "b1c.csv",
    "L1CA": "l1ca.csv",
    "E5AQ": "e5.csv",
    "E5BQ": "e5.csv",
}
"""Chips printed by the ICD, checked below; a signal without them cannot be registered."""

CROSS_STRIDE = {"B1CD": 6, "B1CP": 6, "E5AQ": 6, "E5BQ": 6}
"""Every n-th PRN against all others, to save time on the long codes."""


def codes(signal: str) -> np.ndarray:
    return np.array([_core.code_chips(signal, p) for p in signal_spec(signal).prns], float)


def random_code_bound(length: int, trials: int) -> float:
    """Largest correlation expected of random codes in so many trials (Gaussian tail)."""
    return float(np.sqrt(2 * length * np.log(length * trials)))


def worst_cross_correlation(chips: np.ndarray, stride: int) -> float:
    spectra = np.fft.rfft(chips, axis=1)
    worst = 0.0
    for i in range(0, len(chips), stride):
        others = np.delete(spectra, i, axis=0)
        cross = np.fft.irfft(spectra[i] * others.conj(), chips.shape[1], axis=1)
        worst = max(worst, float(np.abs(cross).max()))
    return worst


@pytest.mark.parametrize("signal", SIGNALS)
def test_specification(signal: str) -> None:
    spec = signal_spec(signal)
    assert spec.id == signal
    assert signal in components(spec.composite)
    shares = sum(signal_spec(s).power_share for s in components(spec.composite))
    assert shares == pytest.approx(1.0)
    assert list(spec.prns) == sorted(set(spec.prns))
    assert spec.min_half_bandwidth_hz >= spec.chip_rate_hz / 2
    # A code period is a whole number of milliseconds in every system.
    assert spec.period_s * 1e3 == pytest.approx(round(spec.period_s * 1e3), abs=1e-9)


@pytest.mark.parametrize("signal", SIGNALS)
def test_length_values_and_balance(signal: str) -> None:
    chips = codes(signal)
    assert chips.shape[1] == signal_spec(signal).code_length
    assert set(np.unique(chips)) == {-1.0, 1.0}
    bound = random_code_bound(1, len(chips)) * np.sqrt(chips.shape[1])
    assert np.abs(chips.sum(axis=1)).max() <= (bound if signal in UNBALANCED else 2)


@pytest.mark.parametrize("signal", SIGNALS)
def test_autocorrelation(signal: str) -> None:
    chips = codes(signal)
    length = chips.shape[1]
    spectra = np.fft.rfft(chips, axis=1)
    auto = np.fft.irfft(np.abs(spectra) ** 2, length, axis=1)
    assert np.allclose(auto[:, 0], length)
    assert np.abs(auto[:, 1:]).max() < random_code_bound(length, len(chips))


@pytest.mark.parametrize("signal", SIGNALS)
def test_cross_correlation(signal: str) -> None:
    chips = codes(signal)
    worst = worst_cross_correlation(chips, CROSS_STRIDE.get(signal, 1))
    assert worst < random_code_bound(chips.shape[1], len(chips) ** 2)


def test_components_of_a_satellite_have_different_codes() -> None:
    for one, other in itertools.combinations(SIGNALS, 2):
        a, b = signal_spec(one), signal_spec(other)
        for prn in sorted({*a.prns} & {*b.prns})[:5]:
            assert not np.array_equal(_core.code_chips(one, prn), _core.code_chips(other, prn))


def test_gold_codes_of_l1ca_are_three_valued() -> None:
    """IS-GPS-200: correlations of the 1023-chip Gold codes are -65, -1 or 63."""
    chips = codes("L1CA")
    spectra = np.fft.rfft(chips, axis=1)
    for i in range(0, len(chips), 9):
        cross = np.fft.irfft(spectra[i] * spectra.conj(), 1023, axis=1)
        assert set(np.rint(np.delete(cross, i, axis=0)).astype(int).ravel()) <= {-65, -1, 63}


@pytest.mark.parametrize("signal", SIGNALS)
def test_symbols(signal: str) -> None:
    for prn in signal_spec(signal).prns:
        periods = _core.periods_per_symbol(signal, prn)
        assert periods is None or periods >= 1


@pytest.mark.parametrize("signal", SIGNALS)
def test_secondary_code(signal: str) -> None:
    overlays = {p: _core.secondary_chips(signal, p) for p in signal_spec(signal).prns}
    assert any(o.size for o in overlays.values()) == (signal not in NO_OVERLAY)
    for prn, overlay in overlays.items():
        if overlay.size:
            assert set(np.unique(overlay)) == {-1, 1}
            assert _core.periods_per_symbol(signal, prn) in (None, overlay.size)
            # No secondary code is perfectly balanced: NH20 has 12 zeros and 8 ones.
            assert abs(int(overlay.sum())) <= 0.2 * overlay.size


def test_every_signal_has_vectors_of_its_icd() -> None:
    assert set(VECTORS_OF) == set(SIGNALS)
    assert all((VECTORS / name).is_file() for name in VECTORS_OF.values())


def test_secondary_codes_of_b1c_pilot() -> None:
    prns = signal_spec("B1CP").prns
    chips = np.array([_core.secondary_chips("B1CP", p) for p in prns], float)
    assert chips.shape[1] == 1800
    spectra = np.fft.rfft(chips, axis=1)
    auto = np.fft.irfft(np.abs(spectra) ** 2, 1800, axis=1)
    assert np.abs(auto[:, 1:]).max() < random_code_bound(1800, len(prns))
    assert worst_cross_correlation(chips, 1) < random_code_bound(1800, len(prns) ** 2)


def test_nh20() -> None:
    """BDS-SIS-ICD-B1I-3.0 section 5.2.2: 0 0 0 0 0 1 0 0 1 1 0 1 0 1 0 0 1 1 1 0."""
    bits = "00000100110101001110"
    expected = [1 if bit == "0" else -1 for bit in bits]
    assert _core.secondary_chips("B1I", 6).tolist() == expected
    assert _core.secondary_chips("B1I", 5).size == 0
    assert (_core.periods_per_symbol("B1I", 6), _core.periods_per_symbol("B1I", 5)) == (20, 2)


def octal(chips: np.ndarray, digits: int) -> str:
    bits = "".join("0" if c > 0 else "1" for c in chips)
    return f"{int(bits, 2):0{digits}o}"


def rows(name: str) -> list[dict[str, str]]:
    with (VECTORS / name).open(newline="") as file:
        return list(csv.DictReader(file))


def ends(chips: np.ndarray) -> tuple[str, str]:
    return octal(chips[:24], 8), octal(chips[-24:], 8)


def test_b1i_against_the_icd() -> None:
    table = rows("b1i.csv")
    assert [int(r["prn"]) for r in table] == list(range(1, 64))
    for row in table:
        chips = _core.code_chips("B1I", int(row["prn"]))
        assert ends(chips) == (row["first24_octal"], row["last24_octal"]), row["prn"]


@pytest.mark.parametrize(
    ("signal", "column"), [("B1CD", "data"), ("B1CP", "pilot"), ("B1CP", "secondary")]
)
def test_b1c_against_the_icd(signal: str, column: str) -> None:
    """Satellites that send B1C; the GEO rows of the table are checked in signal/b1c.rs."""
    read = _core.secondary_chips if column == "secondary" else _core.code_chips
    checked = 0
    for row in rows("b1c.csv"):
        if int(row["prn"]) in signal_spec(signal).prns:
            expected = (row[f"{column}_first24_octal"], row[f"{column}_last24_octal"])
            assert ends(read(signal, int(row["prn"]))) == expected, row["prn"]
            checked += 1
    assert checked == 53


def test_l1ca_against_the_icd() -> None:
    table = rows("l1ca.csv")
    assert len(table) == 32 + 19 + 5
    for row in table:
        assert octal(_core.code_chips("L1CA", int(row["prn"]))[:10], 4) == row["first10_octal"]


def hexadecimal(chips: np.ndarray) -> str:
    bits = "".join("0" if c > 0 else "1" for c in chips)
    return f"{int(bits, 2):0{-(-len(bits) // 4)}X}"


@pytest.mark.parametrize("signal", ["E5AQ", "E5BQ"])
def test_e5_against_the_icd(signal: str) -> None:
    table = rows("e5.csv")
    assert tuple(int(r["prn"]) for r in table) == signal_spec(signal).prns
    for row in table:
        prn, column = int(row["prn"]), signal.lower()
        chips = _core.code_chips(signal, prn)
        assert hexadecimal(chips[:24]) == row[f"{column}_first24_hex"], prn
        assert hexadecimal(chips[-24:]) == row[f"{column}_last24_hex"], prn
        secondary = _core.secondary_chips(signal, prn)
        assert hexadecimal(secondary) == row[f"{column}_secondary_hex"], prn


def test_what_a_satellite_does_not_send_is_refused() -> None:
    with pytest.raises(ValueError, match="B1CP has no PRN 3"):
        _core.code_chips("B1CP", 3)
    with pytest.raises(SignalError, match="known signals: B1I"):
        signal_spec("E1B")
    with pytest.raises(SignalError, match="known signals"):
        components("E1")
