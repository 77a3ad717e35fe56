"""Acceptance numbers of drawn shares."""

from __future__ import annotations

import math

from sdr_spoof.reproduce.study import Number, near


def four_sigmas(share: float, runs: float) -> float:
    """Four standard errors of a share of so many runs."""
    return 4 * math.sqrt(share * (1 - share) / runs)


def drawn(
    name: str,
    what: str,
    value: float,
    reference: float,
    runs: int,
    *,
    other_runs: float = math.inf,
    share: float = 0.0,
) -> Number:
    """A drawn share within four standard errors of its law, or of another simulation's share.

    Args:
        name: as of :class:`Number`.
        what: likewise.
        value: the share.
        reference: the law, or what the other simulation found.
        runs: of ours.
        other_runs: of the other simulation.
        share: of the reference that is allowed besides.
    """
    spread = math.hypot(four_sigmas(reference, runs), four_sigmas(reference, other_runs))
    return near(name, what, value, reference, spread + share * reference + 0.5 / runs)
