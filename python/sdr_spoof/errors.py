"""Errors that a user can act on: each carries data and says what to do.

The command line prints the message of any :class:`SdrSpoofError` on stderr and exits non-zero.
"""


class SdrSpoofError(Exception):
    """Base of every error that the project raises on purpose."""


class ConfigError(SdrSpoofError, ValueError):
    """A configuration or scenario file, or a command-line value, is wrong."""


class RecordingError(SdrSpoofError, OSError):
    """A recording cannot be read: missing, empty, truncated, or not what its metadata says."""


class SignalError(SdrSpoofError, ValueError):
    """A signal is unknown, or the recording cannot hold it (rate too low, band outside)."""


class OutputError(SdrSpoofError, OSError):
    """An output cannot be written: it exists already, or the disk is full."""


class NavigationError(SdrSpoofError, ValueError):
    """Navigation data are wrong: a file that is none, a value that does not fit its message."""


class AidingError(SdrSpoofError, ValueError):
    """GNSS measurements and an IMU's do not go together, or are too few for an aided position."""


class ObservationError(SdrSpoofError, ValueError):
    """A file of observations cannot be read."""


class InertialError(SdrSpoofError, ValueError):
    """Inertial data are wrong, or do not allow an alignment."""
