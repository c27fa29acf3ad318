"""Predictive scheduling: motion of spheres, and of shapes inside of them, from event to event."""
