"""How two sweeps differ."""
