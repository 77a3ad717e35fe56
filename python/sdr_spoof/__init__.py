"""A software-defined GNSS receiver that can tell when it is being lied to."""
