"""Inertial sensors: their errors, what they sense along a trajectory, and files of them."""
