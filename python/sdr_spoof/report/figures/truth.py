"""What is known of an attack, drawn where a truth sidecar is given."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class TruthMark:
    """What is known of an attack, drawn where a truth sidecar is given."""

    start_s: float
    """The spoofer comes on the air."""
    capture_s: float | None = None
    """It is as strong as the satellite."""
    drag_start_s: float | None = None
    """It begins to pull code and carrier away."""
    system: str = "C"
    prn: int | None = None

    def concerns(self, system: str, prn: int) -> bool:
        """Whether it is about this satellite."""
        return self.prn in (None, prn) and self.system == system

    def lines(self) -> list[tuple[float, str, tuple[int, tuple[int, ...]]]]:
        """(time, what happens, line style)."""
        steps = (
            (self.start_s, "spoofer on the air", (0, (1, 2))),
            (self.capture_s, "as strong as the satellite", (0, (5, 3))),
            (self.drag_start_s, "drags", (0, (9, 2, 2, 2))),
        )
        return [
            (s, f"truth: {what} from {s:.2f} s", dash) for s, what, dash in steps if s is not None
        ]
