"""Commands as a user runs them, for the tests of this folder."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from sdr_spoof.cli import main

SCRIPT = Path(sys.executable).with_name("sdr-spoof")
RECORDINGS = Path(__file__).parents[1] / "vectors" / "recordings"
REAL = RECORDINGS / "L1_20211202_084700_4MHz_IQ.bin"

SCENARIO = """
[recording]
duration_s = 2.0
sample_rate_hz = 5e6
lo_hz = 1575.42e6
sample_format = "ci8"
[[satellite]]
prn = 27
signals = ["B1C"]
"""


def failing(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> tuple[int, str]:
    """Run a command that must fail; returns its exit code and message."""
    code = main([str(a) for a in arguments])
    output = capsys.readouterr()
    assert code != 0
    assert output.out == ""
    assert "Traceback" not in output.err
    return code, output.err


def run(*arguments: str | Path, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(SCRIPT), *map(str, arguments)],
        text=True,
        capture_output=True,
        check=False,
        timeout=120,
        **options,  # type: ignore[call-overload]
    )


def scenario_file(folder: Path, text: str = SCENARIO) -> Path:
    path = folder / "scenario.toml"
    path.write_text(text)
    return path
