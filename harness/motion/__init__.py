"""Laws of motion: where bodies are at a time, what answers a hit, what is kept of it; `predictive` has events."""
