"""GNSS against INS and DME: measurement model, simulation, linear statistics, isolation."""
