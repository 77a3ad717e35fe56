"""Report: the verdict as a self-contained HTML file and in the terminal.

Names are imported from their modules when first used: a process that only draws needs few of them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .figures.truth import TruthMark
    from .html import write_report
    from .spectrum import Spectrum, estimate_spectrum
    from .terminal import print_verdict

__all__ = ["Spectrum", "TruthMark", "estimate_spectrum", "print_verdict", "write_report"]

_MODULE_OF = {
    "Spectrum": "spectrum",
    "TruthMark": "figures.truth",
    "estimate_spectrum": "spectrum",
    "print_verdict": "terminal",
    "write_report": "html",
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in _MODULE_OF:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(import_module(f".{_MODULE_OF[name]}", __name__), name)
