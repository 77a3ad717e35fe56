"""Hands runs to workers and writes them down as they end."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.errors import SdrSpoofError

from .journal import Record
from .points import Job, Point

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from .columns import Value
    from .workers import Workers

RunFunction = Callable[[Point, int], "dict[str, Value]"]
"""Of point and seed; must be importable by name, since workers are other processes."""

LONGEST_ERROR = 300
GONE = "the cluster is gone; runs that ended are kept: run the same command again to go on"
DIED = "the worker process ended; it may have been out of memory"


def attempt(function: RunFunction, job: Job, names: tuple[str, ...]) -> Record:
    """One run, in a worker; a failure is a result too."""
    try:
        row = function(job.point, job.seed)
        return _record(job, "", tuple(_plain(row.get(name)) for name in names))
    except Exception as error:  # whatever it is, the other runs go on
        return _failure(job, f"{type(error).__name__}: {error}")


def execute(
    jobs: Iterator[Job],
    function: RunFunction,
    names: tuple[str, ...],
    workers: Workers,
) -> Generator[Record]:
    """Run every job; yields the results in the order in which they end.

    A worker that dies takes down the pool and what it was doing: those runs are made again one by
    one, and one that alone kills its worker is a failure.

    Raises:
        SdrSpoofError: the cluster is gone.
    """
    executor = workers.executor
    pending: dict[Future[Record], Job] = {}
    while True:
        broken: list[Job] = []
        try:
            for job in _up_to(workers.window - len(pending), jobs):
                broken = [job]
                pending[executor.submit(attempt, function, job, names)] = job
                broken = []
            if not pending:
                return
            done, _ = wait(pending, return_when=FIRST_COMPLETED)
            for future in done:
                job = pending[future]
                yield _result(future, job)
                del pending[future]
        except BrokenExecutor:
            suspects = [*pending.values(), *broken]
            executor = yield from _one_by_one(suspects, function, names, workers)
            pending = {}


def _up_to(count: int, jobs: Iterator[Job]) -> Iterator[Job]:
    """No more than so many of the jobs."""
    return (job for _, job in zip(range(count), jobs, strict=False))


def _one_by_one(
    suspects: list[Job], function: RunFunction, names: tuple[str, ...], workers: Workers
) -> Generator[Record, None, Executor]:
    """Run what was under way when a worker died; returns an executor that is whole."""
    executor = _renewed(workers)
    for job in suspects:
        try:
            record = executor.submit(attempt, function, job, names).result()
        except BrokenExecutor:
            record = _failure(job, DIED)
            executor = _renewed(workers)
        yield record
    return executor


def _result(future: Future[Record], job: Job) -> Record:
    try:
        return future.result()
    except BrokenExecutor:
        raise
    except CancelledError as error:
        raise SdrSpoofError(GONE) from error
    except Exception as error:  # of a cluster: its worker died, or could not take the run
        return _failure(job, f"{type(error).__name__}: {error}")


def _renewed(workers: Workers) -> Executor:
    if workers.renew is None:
        raise SdrSpoofError(GONE)
    return workers.renew()


def _failure(job: Job, why: str) -> Record:
    return _record(job, " ".join(why.split())[:LONGEST_ERROR], ())


def _record(job: Job, error: str, values: tuple[Any, ...]) -> Record:
    return Record(job.point.index, job.run, job.seed, error, values)


def _plain(value: Any) -> Any:
    """Numbers of numpy as those of Python."""
    return value.item() if isinstance(value, np.generic) else value
