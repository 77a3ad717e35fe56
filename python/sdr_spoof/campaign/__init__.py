"""Campaigns: many runs of a scenario with other seeds and settings, and what comes of them.

All Monte Carlo goes through here. A run is a pure function of a point of the sweep and a seed
(:mod:`~sdr_spoof.campaign.run`); runs are made by any :class:`concurrent.futures.Executor`, written
as they end, and go on where an earlier attempt stopped.
"""

from .engine import Plan, Results, plan_campaign, run_campaign
from .points import Job, Point
from .run import run
from .spec import CampaignSpec, load_spec
from .table import Table, read_table

__all__ = [
    "CampaignSpec",
    "Job",
    "Plan",
    "Point",
    "Results",
    "Table",
    "load_spec",
    "plan_campaign",
    "read_table",
    "run",
    "run_campaign",
]
