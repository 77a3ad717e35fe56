"""Fields of messages, block codes and parity: against definitions and published figures."""

import numpy as np
import pytest
from scipy.stats import norm

from sdr_spoof.errors import NavigationError
from sdr_spoof.nav import accuracy, bch15, lnav_words
from sdr_spoof.nav.bits import SEMICIRCLE, Field, layout, number_of, wrapped


def test_a_field_is_split_and_signed() -> None:
    field = Field("toc", ((74, 9), (91, 8)), 8.0)
    bits = np.zeros(300, np.uint8)
    field.write(bits, 8.0 * 0b1_0110_0111_1000_0001)
    assert bits[73:82].tolist() == [1, 0, 1, 1, 0, 0, 1, 1, 1]
    assert bits[90:98].tolist() == [1, 0, 0, 0, 0, 0, 0, 1]
    assert field.read(bits) == 8.0 * 0b1_0110_0111_1000_0001
    signed = Field("a2", ((1, 11),), 0.5, signed=True)
    for value in (-512.0, -0.5, 0.0, 511.5):
        signed.write(bits, value)
        assert signed.read(bits) == value


@pytest.mark.parametrize("value", [-0.6, 8.0, float("nan"), float("inf")])
def test_what_does_not_fit_is_refused(value: float) -> None:
    with pytest.raises(NavigationError, match="URA is"):
        Field("URA", ((1, 3),)).write(np.zeros(9, np.uint8), value)


def test_a_layout_may_go_over_pages() -> None:
    pages = layout(("e", "1:125-134 2:47-52 2:61-76", 2.0**-33), ("n", "3:1"))
    bits = np.zeros(900, np.uint8)
    pages.write(bits, {"e": 0.0123, "n": 1})
    assert pages.read(bits)["e"] == pytest.approx(0.0123, abs=2.0**-34)
    assert bits[600] == 1
    assert bits[300:346].sum() == 0


def test_angles_are_turned_into_their_field() -> None:
    field = Field("m0", ((1, 32),), SEMICIRCLE * 2.0**-31, signed=True)
    for angle in (-SEMICIRCLE, SEMICIRCLE, 3 * SEMICIRCLE - 1e-12, 7.0, -9.0):
        assert abs(field.integer(wrapped(angle, field.scale))) <= 1 << 31
        turns = (wrapped(angle, field.scale) - angle) / (2 * SEMICIRCLE)
        assert turns == pytest.approx(round(turns), abs=1e-9)


def test_accuracy_index() -> None:
    assert [accuracy.metres(n) for n in (0, 1, 2, 3, 6, 7, 14)] == [2, 2.8, 4, 5.7, 16, 32, 4096]
    assert np.isnan(accuracy.metres(15))
    for n in range(16):
        assert accuracy.index(accuracy.metres(n)) == n


def codewords() -> np.ndarray:
    """All 2048, by their information bits."""
    bits = np.zeros((2048, 300), np.uint8)
    information = np.arange(2048)[:, None] >> np.arange(10, -1, -1) & 1
    bits[:, bch15.PLACES[0, : bch15.INFORMATION]] = information
    bch15.encode(bits)
    return bits[:, bch15.PLACES[0]]


def test_block_code_has_the_generator_of_the_icd() -> None:
    words = codewords()
    # The shift register of the ICD (figure 5-3), bit by bit: feedback to stages 0 and 1.
    for word in (0, 1, 0b10110011101, 2047):
        register = 0
        for k in range(10, -1, -1):
            feedback = (register >> 3 & 1) ^ (word >> k & 1)
            register = (register << 1 & 15) ^ (0b0011 if feedback else 0)
        assert number_of(words[word]) == word << 4 | register
    # Parity-check matrix of the code as other implementations have it.
    checks = (0x7AC8, 0x3D64, 0x1EB2, 0x7591)
    for codeword in words:
        assert all((number_of(codeword) & c).bit_count() % 2 == 0 for c in checks)
    distance = words[1:].sum(axis=1).min()
    assert distance == 3


def test_interleaving_of_words() -> None:
    # BDS-SIS-ICD-B1I-3.0, 5.1.3: X1 of block 1, X1 of block 2, X2 of block 1 and so on.
    rng = np.random.default_rng(3)
    bits = rng.integers(0, 2, (1, 300)).astype(np.uint8)
    sent = (bch15.encode(bits) < 0).astype(np.uint8)[0]
    word = bits[0, 30:60]
    first, second = np.append(word[:11], word[22:26]), np.append(word[11:22], word[26:30])
    assert sent[30:60].tolist() == np.stack([first, second], axis=1).reshape(-1).tolist()
    assert sent[:30].tolist() == bits[0, :30].tolist()


def test_one_error_a_block_is_corrected() -> None:
    rng = np.random.default_rng(4)
    bits = rng.integers(0, 2, (20, 300)).astype(np.uint8)
    soft = bch15.encode(bits).astype(np.float32)
    for block in bch15.SENT:
        wrong = rng.choice(block)
        soft[:, wrong] *= -0.3
    decoded = bch15.decode(soft, 0.3)
    assert (decoded.bits[:, 15:] == bits[:, 15:]).all()
    assert (decoded.corrected == 1).all()
    assert decoded.doubt.max() < 0.01
    assert (bch15.correct((soft < 0).astype(np.uint8))[:, 15:] == bits[:, 15:]).all()


def test_parity_of_lnav() -> None:
    # Masks over D29* D30* d1..d24 of D25..D30 that several receivers print.
    masks = (0x2EC7CD2, 0x1763E69, 0x2BB1F34, 0x15D8F9A, 0x1AEC7CD, 0x22DEA27)
    for row, mask in enumerate(masks):
        printed = [mask >> k & 1 for k in range(25, -1, -1)]
        assert printed == [*lnav_words.FROM_BEFORE[row], *lnav_words.FROM_DATA[row]]


def test_lnav_words_of_either_sign_pass_and_errors_fail() -> None:
    rng = np.random.default_rng(5)
    bits = rng.integers(0, 2, (50, 300)).astype(np.uint8)
    sent = (lnav_words.encode(bits) < 0).astype(np.uint8)
    assert not lnav_words.failing(sent).any()
    assert not sent[:, [58, 59, 298, 299]].any()  # words 2 and 10 end in 00
    for wrong in range(300):
        spoilt = sent.copy()
        spoilt[:, wrong] ^= 1
        assert lnav_words.failing(spoilt)[:, wrong // 30].all()


def test_two_errors_a_word_are_corrected_where_symbols_are_weak() -> None:
    rng = np.random.default_rng(6)
    bits = rng.integers(0, 2, (20, 300)).astype(np.uint8)
    soft = lnav_words.encode(bits).astype(np.float32)
    for word in range(10):
        wrong = word * 30 + rng.choice(30, 2, replace=False)
        soft[:, wrong] *= -0.1
    decoded = lnav_words.decode(soft, 0.3)
    assert (decoded.bits == bits).all()
    assert (decoded.corrected == 2).all()
    assert decoded.doubt.max() < 1e-3


def _error_rates(code, snr_db: float) -> tuple[float, float, float]:
    """Share of wrong words by soft decisions, mean doubt, share of wrong ones not doubted."""
    rng = np.random.default_rng(7)
    bits = rng.integers(0, 2, (600, 300)).astype(np.uint8)
    sigma = np.sqrt(0.5 / 10 ** (snr_db / 10))
    symbols = code.encode(bits)
    soft = symbols + sigma * rng.standard_normal(symbols.shape)
    decoded = code.decode(soft.astype(np.float32), sigma)
    wrong = (
        (decoded.bits != bits)[:, bch15.PLACES].any(axis=2)
        if code is bch15
        else (decoded.bits != bits).reshape(-1, 10, 30).any(axis=2)
    )
    return wrong.mean(), decoded.doubt.mean(), (wrong & (decoded.doubt < 1e-3)).mean()


@pytest.mark.parametrize("code", [bch15, lnav_words])
def test_doubt_is_the_share_of_wrong_words(code) -> None:
    wrong, doubt, trusted = _error_rates(code, 2.5)
    assert wrong == pytest.approx(doubt, rel=0.2 if code is bch15 else 1.5)
    assert wrong < doubt * 1.2
    assert trusted < 1e-3


def test_soft_decisions_are_two_db_better_than_hard_ones() -> None:
    # Hard decisions: a block of 15 is wrong with two errors or more.
    p = norm.sf(np.sqrt(2 * 10 ** (4.0 / 10)))
    hard = 1 - (1 - p) ** 15 - 15 * p * (1 - p) ** 14
    soft, _, _ = _error_rates(bch15, 4.0)
    assert hard == pytest.approx(0.0145, abs=2e-3)
    assert soft < hard / 5
