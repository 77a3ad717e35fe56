"""Runs in worker processes: pure functions of a case and a seed, so that nothing depends on it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import TypeVar

import numpy as np

from sdr_spoof.campaign.workers import local
from sdr_spoof.progress import Progress

Case = TypeVar("Case")
Found = TypeVar("Found")

CHUNK = 8
"""Runs handed to a worker at a time."""


def workers(threads: int) -> AbstractContextManager[Executor | None]:
    """Processes for :func:`repeat`; None for one thread, which needs no other."""
    return nullcontext() if threads == 1 else _pool(threads)


@contextmanager
def _pool(threads: int) -> Iterator[Executor]:
    with local(threads) as pool:
        yield pool.executor


def seed_of(study: int, case: Iterable[float], number: int) -> int:
    """Seed of one run: of the case's values, not of its place in a sweep."""
    values = [study, number, *(round(1000 * v) for v in case)]
    return int(np.random.SeedSequence(values).generate_state(1, np.uint64)[0] >> 1)


def repeat(
    function: Callable[[Case, int], Found],
    jobs: Sequence[tuple[Case, int]],
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> list[Found]:
    """Call the function for every case and seed; the results are in the order of the jobs."""
    found: Iterable[Found]
    if executor is None:
        found = (function(*job) for job in jobs)
    else:
        found = executor.map(function, *zip(*jobs, strict=True), chunksize=CHUNK)
    done: list[Found] = []
    for one in found:
        done.append(one)
        if progress:
            progress(len(done), len(jobs))
    return done
