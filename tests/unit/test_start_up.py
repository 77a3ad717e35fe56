"""What the command line loads before it knows what to do."""

import subprocess
import sys

SLOW = (
    *("scipy.stats", "scipy.optimize", "scipy.special", "scipy.signal", "scipy.ndimage"),
    *("matplotlib", "h5py", "rich", "jinja2", "sdr_spoof.nav.messages"),
)


def test_the_command_line_loads_nothing_slow():
    """Such modules are written ``scipy.special.ndtri`` after ``import scipy``: loaded when used."""
    code = f"import sys, sdr_spoof.cli; print([m for m in {SLOW} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_process_that_draws_loads_nothing_but_matplotlib():
    """Its start is part of what a report takes."""
    code = f"import sys, sdr_spoof.report.drawer; print([m for m in {SLOW} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "['matplotlib']"
