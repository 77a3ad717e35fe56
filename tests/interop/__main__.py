"""Other people's receivers on our recordings, and ours on theirs: ``make interop``.

Peers that are missing are skipped, with a word on how to get them. Exit code 1: a peer that is
there did not get what it should.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import gnss_sdr
import pocket_sdr
import rtklib
import signal_sim
from outcome import PeerMissingError

PEERS = {
    "gnss-sdr": gnss_sdr.run,
    "rtklib": rtklib.run,
    "pocket-sdr": pocket_sdr.run,
    "signalsim": signal_sim.run,
}


def main() -> int:
    """Run the peers named, or all; returns the exit code."""
    parser = argparse.ArgumentParser(prog="tests/interop", description=__doc__)
    parser.add_argument("peers", nargs="*", metavar="PEER", help=f"of {', '.join(PEERS)}")
    parser.add_argument("--output", type=Path, default=Path("out/interop"), help="folder")
    parser.add_argument("--keep", action="store_true", help="keep the recordings (4 GB)")
    arguments = parser.parse_args()
    unknown = set(arguments.peers) - set(PEERS)
    if unknown:
        parser.error(
            f"no peer is called {', '.join(sorted(unknown))}; there are {', '.join(PEERS)}"
        )
    arguments.output.mkdir(parents=True, exist_ok=True)
    try:
        passed = [_run(name, arguments.output) for name in arguments.peers or PEERS]
    finally:
        if not arguments.keep:
            for samples in arguments.output.glob("*.sigmf-data"):
                samples.unlink()
    return 0 if all(passed) else 1


def _run(name: str, folder: Path) -> bool:
    """One peer; a missing one passes."""
    try:
        outcomes = PEERS[name](folder)
    except PeerMissingError as error:
        print(f"skipped  {name}: {error}", flush=True)
        return True
    for outcome in outcomes:
        word = "passed" if outcome.passed else "FAILED"
        print(f"{word}   {outcome.peer}, {outcome.test}: {outcome.figures}", flush=True)
    return all(outcome.passed for outcome in outcomes)


if __name__ == "__main__":
    sys.exit(main())
