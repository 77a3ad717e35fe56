"""What else knows how the receiver moves: inertial sensors, and detectors that ask them."""
