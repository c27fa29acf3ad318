"""What answers a run's question, a file a method: it plans, loads what the plan keeps, and flies that."""
