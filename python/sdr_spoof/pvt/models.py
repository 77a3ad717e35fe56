"""What the solver knows of noise, atmosphere and thresholds, from the configuration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from sdr_spoof.errors import NavigationError
from sdr_spoof.nav.atmosphere import core_model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.nav.broadcast import Ionosphere
    from sdr_spoof.nav.store import Store
    from sdr_spoof.nav.time import GnssTime

    from .config import PvtConfig

MOST_FREEDOM = 200
"""Degrees of freedom for which there are thresholds: more signals than any epoch has."""


def settings(
    config: PvtConfig, systems: Sequence[str], store: Store, time: GnssTime
) -> dict[str, Any]:
    """What the core's solver takes for all epochs.

    Raises:
        NavigationError: if a model of the ionosphere is asked for whose parameters are missing.
    """
    horizon = config.weights in ("elevation", "cn0-elevation")
    freedom = np.arange(1, MOST_FREEDOM + 1)
    return {
        "elevation_mask": float(np.radians(config.elevation_mask_deg)),
        "zenith_sigma_m": config.zenith_sigma_m if horizon else 0.0,
        "ionosphere": [core_model(ionosphere(config, s, store, time)) for s in systems],
        "troposphere": config.troposphere != "none",
        "max_pdop": config.max_pdop,
        "thresholds": scipy.special.chdtri(freedom, config.raim_false_alarm).tolist(),
        "exclusions": config.raim_exclusions,
    }


def ionosphere(config: PvtConfig, system: str, store: Store, time: GnssTime) -> Ionosphere | None:
    """Model that a system's signals are corrected by.

    Raises:
        NavigationError: as :func:`settings`.
    """
    if config.ionosphere == "none":
        return None
    own, other = (store.klobuchar(s, time) for s in ("CG" if system == "C" else "GC"))
    klobuchar = _fullest(own, other)
    bdgim = store.bdgim(time)
    if config.ionosphere == "klobuchar":
        return _found(klobuchar, "klobuchar")
    if config.ionosphere == "bdgim":
        return _found(bdgim, "bdgim")
    return _fullest(bdgim, klobuchar) if system == "C" else _fullest(own, bdgim, klobuchar)


def _fullest(*models: Ionosphere | None) -> Ionosphere | None:
    """The first that says anything, or else the first there is."""
    known = [m for m in models if m is not None]
    return next((m for m in known if not m.blank), next(iter(known), None))


def _found(model: Ionosphere | None, name: str) -> Ionosphere:
    if model is None:
        raise NavigationError(
            f"no parameters of the ionosphere model '{name}' were received; "
            "choose 'auto' or 'none', or give a navigation file that has them"
        )
    return model


def ekf(config: PvtConfig) -> dict[str, float] | None:
    """Process noise of the filter, None for least squares."""
    if config.filter != "ekf":
        return None
    return {
        "acceleration": config.acceleration_m_s2,
        "clock": config.clock_m_s,
        "clock_drift": config.clock_drift_m_s2,
        "bias": config.bias_m_s,
        "coast_s": config.coast_s,
    }
