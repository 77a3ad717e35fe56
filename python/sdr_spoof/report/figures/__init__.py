"""Figures of the report: each module draws one thing and returns a PNG data URI."""
