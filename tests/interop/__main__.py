"""Other people's receivers on our recordings, and ours on theirs: ``make interop``.

One table tells of all. Peers that are missing are skipped, with a word on how to get them. Exit
code 1: a peer that is there did not get what it should.
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

PASSED, FAILED, SKIPPED = "passed", "FAILED", "skipped"
Row = tuple[str, str, str, str]
"""Result, peer, test and figures."""
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
    rows: list[Row] = []
    try:
        for name in arguments.peers or PEERS:
            rows += _run(name, arguments.output)
    finally:
        _print(rows)
        if not arguments.keep:
            for samples in arguments.output.glob("*.sigmf-data"):
                samples.unlink()
    return 1 if any(row[0] == FAILED for row in rows) else 0


def _run(name: str, folder: Path) -> list[Row]:
    """What came of one peer; a missing one passes."""
    print(f"{name} ...", file=sys.stderr, flush=True)
    try:
        outcomes = PEERS[name](folder)
    except PeerMissingError as error:
        return [(SKIPPED, name, "", f"not here: {error}")]
    return [(PASSED if o.passed else FAILED, o.peer, o.test, o.figures) for o in outcomes]


def _print(rows: list[Row]) -> None:
    """All in columns, the last one as long as it is."""
    heads = ("result", "peer", "test", "figures")
    widths = [max(len(row[k]) for row in [heads, *rows]) for k in range(len(heads))]
    for row in [heads, *rows]:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        print("  ".join(cells).rstrip())


if __name__ == "__main__":
    sys.exit(main())
