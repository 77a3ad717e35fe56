"""From observations and an IMU to a verdict and a place that spoofers do not move."""
