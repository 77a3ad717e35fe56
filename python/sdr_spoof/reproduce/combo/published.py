"""Settings and numbers of the combo-signal publication.

The publication prints few numbers: gamma' = 18.83 Hz, 62 % at 8 Hz, over 90 % from 10 Hz and from
eta 1.4; its curves are figures. The values of the curves below were computed by an independent
implementation that meets all of these; Pd is for C/N0 = 30 taken as a ratio.
"""

from __future__ import annotations

import numpy as np

INTEGRATION_S = 0.1
LOOP_BANDWIDTH_HZ = 1.0
PFA = 1e-6
PRINTED_THRESHOLD_HZ = 18.83

ETA = 1.5
DRAG_HZ = 10.0
DRAGS_HZ = np.arange(8.0, 12.51, 0.5)
ETAS = np.round(np.arange(1.1, 2.01, 0.1), 1)
PD_OF_DRAG = (0.6196, 0.7326, 0.8255, 0.8949, 0.9417, 0.9703, 0.9861, 0.9941, 0.9977, 0.9992)
PD_OF_ETA = (0.7782, 0.8399, 0.8854, 0.9182, 0.9417, 0.9583, 0.9700, 0.9783, 0.9842, 0.9884)

READINGS = {"as_ratio": "30 as a ratio (14.77 dB-Hz)", "as_dbhz": "30 dB-Hz"}
"""The two readings of "C/N0 of 30 dB": key of ``PUBLISHED_CN0_HZ``, and in words."""

UPPER_HZ, LOWER_HZ = 1575.42e6, 1561.098e6
CARRIER_DIFFERENCE_MHZ = (UPPER_HZ - LOWER_HZ) / 1e6
