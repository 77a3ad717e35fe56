"""Counts the instructions of a fixed workload and compares with what is kept in the repository.

Times depend on what else a machine does; instruction counts hardly do, so that a slower kernel is
seen on a busy machine too. Each workload of ``instructions.rs`` is run once and twice under
valgrind: the difference is the work without its set-up. Valgrind knows no AVX-512, so the levels
are portable and AVX2.

``make bench-check`` compares, ``make bench-update`` keeps new counts in ``instructions.toml``.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

WORKLOADS = ("W1", "W2", "acquisition", "synthesis", "inertial")
LEVELS = ("portable", "avx2")
TOLERANCE = 0.03
"""Share by which a count may grow: compilers differ, and threads that wait count too."""
KEPT = Path(__file__).with_name("instructions.toml")
HEADER = """\
# Instructions of the workloads in instructions.rs, by level of vector instructions.
# Made by `make bench-update`, compared by `make bench-check`.
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("program", type=Path, help="the built instructions.rs")
    parser.add_argument("--update", action="store_true", help="keep the new counts")
    arguments = parser.parse_args()
    if shutil.which("valgrind") is None:
        sys.exit(
            "valgrind is missing, and instructions cannot be counted without it; install it "
            "(Debian, Ubuntu: apt install valgrind) and try again"
        )
    counts = counted(arguments.program.resolve())
    if arguments.update:
        KEPT.write_text(written(counts), encoding="utf-8")
        print(f"{KEPT}: updated")
    else:
        compare(counts, tomllib.loads(KEPT.read_text(encoding="utf-8")))


def counted(program: Path) -> dict[str, dict[str, int]]:
    """Instructions of each workload, by level."""
    names = subprocess.run([program, "levels"], check=True, capture_output=True, text=True)
    available = names.stdout.split()
    counts: dict[str, dict[str, int]] = {}
    for level in LEVELS:
        if level not in available:
            print(f"{level}: not on this processor, left out")
            continue
        counts[level] = {}
        for workload in WORKLOADS:
            once, twice = (instructions(program, level, workload, n) for n in (1, 2))
            counts[level][workload] = twice - once
            print(f"{level:9}{workload:12}{twice - once:>14,}", flush=True)
    return counts


def instructions(program: Path, level: str, workload: str, times: int) -> int:
    """Instructions of one run of the program, all of its threads."""
    run = subprocess.run(
        [
            *("valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"),
            *(str(program), workload, str(times)),
        ],
        env={**os.environ, "SDR_SPOOF_SIMD": level},
        capture_output=True,
        text=True,
        check=False,
    )
    found = re.search(r"Collected *: *(\d+)", run.stderr)
    if run.returncode or found is None:
        sys.exit(f"valgrind failed on {workload} ({level}):\n{run.stderr}")
    return int(found[1])


def compare(counts: dict[str, dict[str, int]], kept: dict[str, dict[str, int | str]]) -> None:
    """Report the differences; the program ends here if a workload has become slower."""
    built = kept["built"]
    if platform.machine() != built["machine"]:
        sys.exit(f"the counts are for {built['machine']}, this is {platform.machine()}")
    worse = []
    for level, workloads in counts.items():
        for workload, count in workloads.items():
            before = int(kept[level][workload])
            change = count / before - 1
            line = f"{level} {workload}: {count:,} instructions, {before:,} before ({change:+.1%})"
            if change > TOLERANCE:
                worse.append(line)
            elif change < -TOLERANCE:
                print(f"better: {line}; keep it with `make bench-update`")
    if not worse:
        print(f"no workload needs over {TOLERANCE:.0%} more instructions than before")
        return
    print("\n".join(["", "more instructions than before:", *worse]), file=sys.stderr)
    if compiler() != built["compiler"]:
        print(f"({compiler()} now, {built['compiler']} before)", file=sys.stderr)
    sys.exit("find the cause; if it is wanted, keep the new counts with `make bench-update`")


def written(counts: dict[str, dict[str, int]]) -> str:
    """The counts as they are kept."""
    lines = [HEADER, "[built]", f'compiler = "{compiler()}"', f'machine = "{platform.machine()}"']
    for level, workloads in counts.items():
        lines += ["", f"[{level}]"]
        lines += [f"{workload} = {count}" for workload, count in workloads.items()]
    return "\n".join(lines) + "\n"


def compiler() -> str:
    """For example ``rustc 1.89.0``."""
    shown = subprocess.run(["rustc", "--version"], check=True, capture_output=True, text=True)
    return " ".join(shown.stdout.split()[:2])


if __name__ == "__main__":
    main()
