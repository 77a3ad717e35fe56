"""Time of every decision rule for 1e6 epochs of 8 satellites: python benches/rules.py."""

import os
import time

os.environ["RAYON_NUM_THREADS"] = "1"

import numpy as np

from sdr_spoof import decision

z = np.random.default_rng(1).standard_normal((8, 1_000_000))
for rule in decision.RULES.values():
    times = []
    for _ in range(3):
        start = time.process_time()
        rule.run(z)
        times.append(time.process_time() - start)
    print(f"{rule.name:26} {min(times):.3f} s")
