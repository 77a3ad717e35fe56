"""A whole campaign: from the file to the table, going on where an earlier attempt stopped."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .columns import Column, columns
from .folder import Folder, meaning_of, prepare
from .journal import Journal, read_journal
from .points import Point, jobs, points
from .run import run
from .runner import RunFunction, execute
from .spec import CampaignSpec, load_spec
from .table import Table, table_of, write_table
from .workers import cluster, local

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from sdr_spoof.progress import Progress

    from .workers import Workers


@dataclass(frozen=True)
class Plan:
    """A campaign file, understood."""

    file: Path
    spec: CampaignSpec
    points: list[Point]
    columns: list[Column]

    @property
    def total(self) -> int:
        """Runs in all."""
        return len(self.points) * self.spec.campaign.runs

    @property
    def meaning(self) -> dict[str, Any]:
        """Everything that the results depend on."""
        return meaning_of(self.spec, self.columns)


@dataclass(frozen=True)
class Results:
    """What a campaign came to."""

    folder: Path
    table: Table
    total: int
    """Runs of the whole campaign."""
    found: int
    """Runs that were there already when it began."""

    @property
    def failed(self) -> int:
        """Runs that ended with an error."""
        return int((self.table["error"] != "").sum())


def plan_campaign(file: Path | str) -> Plan:
    """Read and check a campaign file; nothing is run.

    Raises:
        ConfigError: it is missing or wrong; the message names file, table and key.
    """
    spec = load_spec(file)
    at = points(spec, file)
    return Plan(Path(file), spec, at, columns(at, spec.output.columns, file))


def run_campaign(
    plan: Plan,
    output: Path | str,
    *,
    workers: int | None = None,
    address: str | None = None,
    force: bool = False,
    function: RunFunction = run,
    progress: Progress | None = None,
) -> Results:
    """Make the runs that are missing in a folder, and the table of all.

    Args:
        plan: what to run.
        output: folder of the results; a campaign begun there goes on.
        workers: processes of this machine, by default one per core.
        address: scheduler of a Dask cluster to use instead, ``tcp://host:port``.
        force: begin anew, whatever the folder holds.
        function: makes a run; must be importable by name.
        progress: called with runs done and runs in all, at once with those that were there.

    Raises:
        ConfigError: the folder holds another campaign, or the cluster cannot be used.
        OutputError: the results cannot be written.
        KeyboardInterrupt: on Ctrl-C; every run that ended is kept, and the message says so.
    """
    folder = Folder(Path(output))
    prepare(folder, plan.file, plan.meaning, force=force)
    with Journal(folder.journal) as journal:
        found = len(journal.done)
        try:
            if found < plan.total:
                with _workers(workers, address) as where:
                    _run_missing(plan, journal, where, function, progress)
        except KeyboardInterrupt as stop:
            _table(plan, folder)
            raise KeyboardInterrupt(
                f"{len(journal.done)} of {plan.total} runs are kept in {folder.path}; "
                "run the same command again to go on"
            ) from stop
        return Results(folder.path, _table(plan, folder), plan.total, found)


def _workers(count: int | None, address: str | None) -> AbstractContextManager[Workers]:
    return local(count) if address is None else cluster(address)


def _run_missing(
    plan: Plan,
    journal: Journal,
    workers: Workers,
    function: RunFunction,
    progress: Progress | None,
) -> None:
    done = set(journal.done)
    missing = (j for j in jobs(plan.spec, plan.points) if (j.point.index, j.run) not in done)
    names = tuple(c.name for c in plan.columns)
    if progress:
        progress(len(done), plan.total)
    with closing(execute(missing, function, names, workers)) as records:
        for record in records:
            journal.append(record)
            if progress:
                progress(len(journal.done), plan.total)


def _table(plan: Plan, folder: Folder) -> Table:
    """Write the table of the runs so far."""
    values_of = [point.values for point in plan.points]
    records = read_journal(folder.journal)
    table = table_of(records, plan.columns, values_of, plan.meaning, plan.total)
    write_table(folder.table, table)
    return table
