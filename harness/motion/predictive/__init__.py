"""Predictive scheduling: exact motion of spheres from event to event."""
