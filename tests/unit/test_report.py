"""The report: self-contained, deterministic, and it says what the verdict says."""

import base64
import io
import re
import types
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from scipy.signal import welch
from simulated_tracks import Attack, Satellite, simulate_log

from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.errors import OutputError
from sdr_spoof.records import Acquisition
from sdr_spoof.report import TruthMark, estimate_spectrum, print_verdict, write_report
from sdr_spoof.report.evidence import EvidenceBook
from sdr_spoof.report.figures import style
from sdr_spoof.report.figures.satellite import code_minus_carrier_m, correlation_shape
from sdr_spoof.report.spectrum import _welch
from sdr_spoof.report.words import headline
from sdr_spoof.verdict import detect

RATE_HZ, LO_HZ = 120e6, 1538.259e6


class ToneRecording:
    """White noise and a tone at B1C, real int8."""

    path = Path("tone")
    gain = None
    sample_count = 1 << 19
    format = types.SimpleNamespace(
        sample_format="ri8",
        sample_rate_hz=RATE_HZ,
        lo_hz=LO_HZ,
        conjugate=False,
        float_scale=1.0,
    )

    def read_raw(self, start, count):
        noise = np.random.default_rng(start).normal(0, 10, count)
        tone = 30 * np.cos(2 * np.pi * (1575.42e6 - LO_HZ) / RATE_HZ * (start + np.arange(count)))
        return np.round(noise + tone).astype(np.int8).view(np.uint8)


@pytest.fixture(scope="module")
def case():
    log = simulate_log(
        Satellite(23, attack=Attack(start_s=5.0, drag_hz=2.0)),
        Satellite(24),
        single=[(Satellite(40, cn0_dbhz=24.0), "B1CP")],
        duration_s=10.0,
    )
    found = [
        Acquisition(t.signal, t.prn, True, 0, t.doppler_hz[0], 1e-3, 45.2, 60.0, 22.0, 50.0)
        for t in log.signals
    ]
    return {
        "recording": ToneRecording(),
        "acquisitions": [*found, Acquisition("B1I", 9, False, 0, 0, 0, 0, 11.0, 22.0, 50.0)],
        "log": log,
        "verdict": detect(log),
        "detection": DetectionConfig(),
        "truth": TruthMark(4.0, 5.0, 6.0, "C", 23),
    }


@pytest.fixture(scope="module")
def report(case, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "report.html"
    return write_report(path, **case).read_text(encoding="utf-8")


def test_nothing_is_loaded_from_elsewhere(report):
    without_images = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", report)
    assert not re.search(r"https?:|<script|<link|@import|url\(", without_images)
    sources = re.findall(r'src="([^"]{0,30})', report)
    assert len(sources) >= 8
    assert all(s.startswith("data:image/png;base64,") for s in sources)


def test_without_what_detection_showed_the_tests_are_made_again(case, report, tmp_path):
    book = EvidenceBook(case["detection"])
    verdict = detect(case["log"], case["detection"], look=book.take)
    path = write_report(tmp_path / "r.html", **{**case, "verdict": verdict}, book=book)
    assert path.read_text(encoding="utf-8") == report


def test_every_image_is_a_png_without_a_date_and_has_a_text(report):
    for data in re.findall(r"base64,([A-Za-z0-9+/=]+)", report):
        png = base64.b64decode(data, validate=True)
        assert png.startswith(b"\x89PNG")
        assert b"tEXt" not in png
    assert all(alt.strip() for alt in re.findall(r'<img[^>]*alt="([^"]*)"', report))


def test_tags_are_closed(report):
    class Balance(HTMLParser):
        open_tags: list[str] = []  # noqa: RUF012

        def handle_starttag(self, tag, attrs):
            if tag not in ("meta", "img"):
                self.open_tags.append(tag)

        def handle_endtag(self, tag):
            assert self.open_tags.pop() == tag

    parser = Balance()
    parser.feed(report)
    assert parser.open_tags == []


def test_the_verdict_comes_first_and_in_words(report, case):
    text = re.sub(r"<style>.*?</style>|<[^>]+>", " ", report, flags=re.S)
    text = " ".join(text.split())
    assert text.index("Spoofing detected", 20) < text.index("Satellites Satellite")
    onset_s = case["verdict"].satellites[0].onset_s
    assert f"C23: its B1C (1575.42 MHz) signal has been captured, since {onset_s:.2f} s." in text
    for part in ("10³⁰ tests", "2 of 3 satellites", "Cannot see", "✔ clean"):
        assert part in text
    assert "detection.window_s" in text
    assert "C40" in text


def test_the_same_input_gives_the_same_bytes(report, case, tmp_path):
    again = write_report(tmp_path / "again.html", **case)
    assert again.read_text(encoding="utf-8") == report


def test_an_existing_file_is_kept(case, tmp_path):
    path = tmp_path / "report.html"
    path.write_text("mine")
    with pytest.raises(OutputError, match="exists already"):
        write_report(path, **case)
    assert path.read_text() == "mine"


def test_names_are_escaped(tmp_path):
    import dataclasses  # noqa: PLC0415

    log = dataclasses.replace(simulate_log(), recording="<b>&.bin", partial=True)
    path = write_report(
        tmp_path / "r.html",
        recording=None,
        acquisitions=[],
        log=log,
        verdict=detect(log),
        detection=DetectionConfig(),
    )
    text = path.read_text(encoding="utf-8")
    assert "&lt;b&gt;&amp;.bin" in text
    assert "Not enough support" in text
    assert "No satellite was tracked" in text
    assert "interrupted" in text


def test_spectrum_finds_the_tone_and_the_noise_level():
    spectrum = estimate_spectrum(ToneRecording(), sections=4)
    peak = spectrum.rf_hz[np.argmax(spectrum.density_db)]
    assert peak == pytest.approx(1575.42e6, abs=RATE_HZ / 4096)
    # Variance 100 (plus 1/12 of rounding) over half the rate, one-sided.
    level = 10 * np.log10((100 + 1 / 12) / (RATE_HZ / 2))
    assert np.median(spectrum.density_db) == pytest.approx(level, abs=0.1)


@pytest.mark.parametrize("is_complex", [False, True])
@pytest.mark.parametrize("bins", [256, 101])
def test_spectrum_is_welchs(is_complex, bins):
    samples = np.random.default_rng(2).normal(size=(2, 3000)).astype(np.float32)
    samples = samples[0] + 1j * samples[1] if is_complex else samples[0]
    expected = welch(samples, fs=5.0, nperseg=bins, detrend=False, return_onesided=not is_complex)
    for ours, theirs in zip(_welch(samples, 5.0, bins), expected, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-4)


def test_detail_numbers():
    log = simulate_log(Satellite(23), duration_s=4.0)
    track = log.signals[1]
    held = track.state > 0
    # The simulated code follows the carrier: what is left is its noise, 0.003 chip of 293 m.
    assert np.std(code_minus_carrier_m(track, held)) == pytest.approx(0.88, rel=0.2)
    shape = correlation_shape(track, held)
    np.testing.assert_allclose(shape, [-0.5, 0.7, 1, 0.7, -0.5, 0], atol=0.01)


def test_long_lines_keep_their_extremes_and_gaps():
    time = np.arange(100_000.0)
    values = np.sin(time / 1e4)
    values[[33_333, 66_666]] = 9.0, -9.0
    values[50_000:50_100] = np.nan
    x, y = style.thinned(time, values)
    assert x.size < 1.6 * style.MOST_POINTS
    assert (np.diff(x) > 0).all()
    np.testing.assert_array_equal(y, values[x.astype(int)])
    assert (np.nanmax(y), np.nanmin(y)) == (9.0, -9.0)
    assert np.isnan(y[(x >= 50_000) & (x < 50_100)]).any()
    assert np.isfinite(y[(x < 50_000) | (x >= 50_100)]).all()
    short = style.thinned(time[:4000], values[:4000])
    np.testing.assert_array_equal(short, (time[:4000], values[:4000]))


def printed(verdict):
    console = Console(file=io.StringIO(), width=100, force_terminal=False)
    print_verdict(verdict, console)
    return " ".join(console.file.getvalue().split())


def test_terminal_verdict(case):
    text = printed(case["verdict"])
    for part in (
        "Spoofing detected",
        "C23",
        "B1C (1575.42 MHz)",
        "not enough support",
        "cannot see",
    ):
        assert part in text


@pytest.mark.parametrize(
    ("satellites", "expected"),
    [([Satellite()], "No spoofing found"), ([], "Not enough support for a verdict")],
)
def test_headlines(satellites, expected):
    verdict = detect(simulate_log(*satellites, duration_s=5.0))
    assert headline(verdict) == expected
    assert expected in printed(verdict)
