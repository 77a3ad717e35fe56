"""Navigation: time, ephemerides, messages, from bits of the air to satellite positions."""
