"""How a metric went over all sweeps of a machine."""
