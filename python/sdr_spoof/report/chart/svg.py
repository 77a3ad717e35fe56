"""Elements of SVG, as text."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

FINE = 10
"""Steps per unit of a picture that the points of lines are rounded to."""
FAR = 1_000_000
"""Points further out are drawn here; nothing that far off is seen."""
_NARROW, _WIDE = set("iljtfrI.,:;|'!()[]/ "), set("mwMWQO@%→✖")


def element(name: str, content: str = "", /, **attributes: str | float | None) -> str:
    """One element; ``stroke_width`` becomes ``stroke-width``, and None is left out.

    ``content`` is markup already.
    """
    words = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{_plain(value)}"'
        for key, value in attributes.items()
        if value is not None
    )
    return f"<{name}{words}>{content}</{name}>" if content else f"<{name}{words}/>"


def _plain(value: str | float) -> str:
    return escape(value) if isinstance(value, str) else f"{round(value, 2):g}"


def text(x: float, y: float, content: str, **attributes: str | float | None) -> str:
    """Text whose baseline begins at a point."""
    return element("text", escape(content), x=x, y=y, **attributes)


def width_of(content: str, size: float) -> float:
    """About how wide a text is; fonts differ."""
    narrow = sum(c in _NARROW for c in content)
    wide = sum(c in _WIDE for c in content)
    return size * (0.62 * (len(content) - narrow - wide) + 0.36 * narrow + 0.95 * wide)


def path(x: NDArray[np.float64], y: NDArray[np.float64]) -> str:
    """Path data through points in units of a picture; broken where one is not finite."""
    known = np.isfinite(x) & np.isfinite(y)
    points = np.stack([x, y], axis=1)
    points = np.where(known[:, None], points, 0.0) * FINE
    fine = np.clip(np.rint(points), -FAR, FAR).astype(np.int64)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], known.astype(np.int8), [0]])))
    return "".join(_run(fine[a:b]) for a, b in edges.reshape(-1, 2).tolist())


def _run(points: NDArray[np.int64]) -> str:
    start = f"M{points[0, 0]} {points[0, 1]}"
    steps = np.diff(points, axis=0)
    steps = steps[steps.any(axis=1)]
    if not steps.size:
        return f"{start}h0"  # a round cap makes a dot of it
    return f"{start}l{' '.join(map(str, steps.ravel().tolist()))}".replace(" -", "-")
