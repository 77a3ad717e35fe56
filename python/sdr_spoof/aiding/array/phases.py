"""What an array measures: phase differences to its reference antenna, and how it was turned."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import AidingError

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class ArrayPhases:
    """Phases of one source at E epochs, and what the INS says; any number of runs leads.

    The differences run on without slips: an unknown whole number of cycles in each is the same at
    all epochs, or none where ``known_cycles``.
    """

    time_s: NDArray[np.float64]
    """(E,)"""
    difference_cycles: NDArray[np.float64]
    """Carrier phase of each antenna less that of the reference, (..., E, A - 1)."""
    attitude_rad: NDArray[np.float64]
    """Yaw, pitch, roll by the INS, (E, 3)."""
    displacement_m: NDArray[np.float64]
    """Of the reference antenna since the first epoch: north, east, down, (E, 3)."""
    sigma_cycles: float
    """Phase noise of one antenna."""
    wavelength_m: float
    expected: NDArray[np.float64] | None = None
    """Unit vectors north, east, down to the satellite by its ephemeris, (E, 3); None: it stands
    still."""
    known_cycles: bool = True
    """Whether the whole cycles are known, as from a calibration."""
    cycle_step: float = 1.0
    """What unknown cycles come in: whole ones, or 0.5 where data hide the carrier's sign."""
    yaw_sigma_rad: float = 0.0
    """Error of the INS's yaw that a random walk since the first epoch has come to at the last,
    standard deviation."""
    bias_sigma_cycles: float = 0.0
    """Unknown constant delay of each antenna's line, standard deviation."""

    def __post_init__(self) -> None:
        """Refuse what does not fit together, and what is no number."""
        epochs = self.time_s.size
        if epochs < 2 or np.any(np.diff(self.time_s) <= 0):
            raise AidingError("phases need two epochs or more, in ascending order of time")
        rows = [
            ("attitudes", self.attitude_rad.shape, (epochs, 3)),
            ("displacements", self.displacement_m.shape, (epochs, 3)),
            ("phase differences", self.difference_cycles.shape[-2:-1], (epochs,)),
        ]
        if self.expected is not None:
            rows.append(("expected directions", self.expected.shape, (epochs, 3)))
        for name, shape, wanted in rows:
            if shape != wanted:
                raise AidingError(f"{name} are of shape {shape}, {wanted} is needed")
        if not (self.sigma_cycles > 0 and self.wavelength_m > 0):
            raise AidingError("phase noise and wavelength must be above 0")
        for name, values in (
            ("a phase difference", self.difference_cycles),
            ("an attitude", self.attitude_rad),
            ("a displacement", self.displacement_m),
        ):
            if not np.isfinite(values).all():
                raise AidingError(f"{name} is not a number; leave such epochs out")

    def at(self, epochs: NDArray[np.intp] | list[int]) -> ArrayPhases:
        """The same at some epochs only, displacements from the first of them."""
        chosen = np.asarray(epochs, np.intp)
        moved = self.displacement_m[chosen]
        return replace(
            self,
            time_s=self.time_s[chosen],
            difference_cycles=self.difference_cycles[..., chosen, :],
            attitude_rad=self.attitude_rad[chosen],
            displacement_m=moved - moved[0],
            expected=None if self.expected is None else self.expected[chosen],
        )
