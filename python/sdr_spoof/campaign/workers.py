"""Where runs are made: processes of this machine, or an existing cluster.

Both are a :class:`concurrent.futures.Executor`, and the runs are the same on either.
"""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from sdr_spoof.errors import ConfigError

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

AHEAD = 3
"""Runs that wait at each worker, so that none is idle while results are written."""
CONNECT_S = 10.0

_ONE_THREAD = {
    name: "1"
    for name in (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
        "NUMEXPR_NUM_THREADS",
        "RAYON_NUM_THREADS",
    )
}


@dataclass
class Workers:
    """Something that runs can be handed to."""

    executor: Executor
    count: int
    renew: Callable[[], Executor] | None = None
    """Makes a new executor after a worker has died; None where the cluster does so by itself."""

    @property
    def window(self) -> int:
        """Runs that are handed over at a time."""
        return self.count * (1 + AHEAD)


@contextmanager
def local(count: int | None = None) -> Iterator[Workers]:
    """Processes of this machine, one thread each; by default one per core.

    They are spawned, not forked, ignore Ctrl-C, and end with this process however it ends.
    """
    count = count or os.cpu_count() or 1
    context = multiprocessing.get_context("spawn")
    reader, writer = context.Pipe(duplex=False)
    pools: list[ProcessPoolExecutor] = []

    def make() -> Executor:
        made = ProcessPoolExecutor(count, context, initializer=_begin, initargs=(reader,))
        pools.append(made)
        return made

    with _environment(_ONE_THREAD):
        try:
            yield Workers(make(), count, make)
        finally:
            writer.close()  # the workers see that and end, even in the middle of a run
            for pool in pools:
                pool.shutdown(wait=True, cancel_futures=True)
            reader.close()


def _begin(stop: Connection) -> None:
    """First thing in a worker: leave Ctrl-C to the parent, and end when it is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, args=(stop,), daemon=True).start()


def _end_with_parent(stop: Connection) -> None:
    # Nothing is ever sent: the pipe closes when the parent wants it to, or dies.
    with contextlib.suppress(EOFError, OSError):
        stop.recv_bytes()
    os._exit(1)


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Variables that processes started meanwhile inherit."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextmanager
def cluster(address: str) -> Iterator[Workers]:
    """The workers of an existing Dask cluster, by the address of its scheduler.

    Raises:
        ConfigError: ``distributed`` is not installed, nothing answers at the address, the cluster
            has no workers, or they have another version of this package.
    """
    try:
        distributed: Any = import_module("distributed")  # an optional extra
    except ImportError as error:
        raise ConfigError(
            "--cluster needs the package distributed: pip install 'sdr-spoof[cluster]'"
        ) from error
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what matters comes as an error
    try:
        client = distributed.Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise ConfigError(
            f"--cluster: no Dask scheduler answers at {address}; it must look like "
            "tcp://127.0.0.1:8786"
        ) from error
    with client:
        count = _check_cluster(client, address)
        executor = client.get_executor(retries=0)
        try:
            yield Workers(executor, count)
        finally:
            executor.shutdown(wait=False)


def _check_cluster(client: Any, address: str) -> int:
    """Number of threads of the workers, all of which have this version."""
    try:
        there = client.run(_version)
    except OSError as error:
        raise ConfigError(f"--cluster: the scheduler at {address} went away: {error}") from error
    if not there:
        raise ConfigError(f"--cluster: the scheduler at {address} has no workers; start some")
    wrong = {f"{worker} has {v or 'none'}" for worker, v in there.items() if v != _version()}
    if wrong:
        raise ConfigError(
            f"--cluster: every worker needs sdr-spoof {_version()}; {', '.join(sorted(wrong))}"
        )
    return int(sum(client.nthreads().values()))


def _version() -> str:
    return version("sdr-spoof")
