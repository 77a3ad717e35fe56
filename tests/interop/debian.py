"""Peers that Debian has."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

from outcome import PeerMissingError


def require(program: str, package: str) -> str:
    """Path of a program, from its package if root may install that.

    Raises:
        PeerMissingError: it is not there and cannot be installed.
    """
    if shutil.which(program) is None and os.geteuid() == 0 and shutil.which("apt-get"):
        for command in (["update"], ["install", "-y", "--no-install-recommends", package]):
            subprocess.run(["apt-get", "-q", *command], check=False, stdout=sys.stderr)
    found = shutil.which(program)
    if found is None:
        raise PeerMissingError(f"{program} is missing; as root: apt-get install {package}")
    return found


def version(package: str) -> str:
    """Of an installed package, empty where dpkg does not know it."""
    query = ["dpkg-query", "-W", "-f=${Version}", package]
    try:
        return subprocess.run(query, capture_output=True, text=True, check=False).stdout.strip()
    except OSError:
        return ""
