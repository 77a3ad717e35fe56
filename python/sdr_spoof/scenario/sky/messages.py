"""Data symbols of a satellite's navigation messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.nav.messages import message_on

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sdr_spoof.nav.broadcast import Broadcast
    from sdr_spoof.nav.time import GnssTime


def symbols(
    content: Broadcast, signal: str, start: GnssTime, duration_s: float
) -> NDArray[np.int8] | None:
    """Symbols +1 and -1 of a registry signal from a time of the satellite's on.

    The orbit is sent in whichever message the signal carries: B-CNAV1 has finer fields than D1.
    None if no message of the signal is known.
    """
    message = message_on(signal, content.ephemeris.prn)
    return None if message is None else message.encode(content, start, duration_s)
