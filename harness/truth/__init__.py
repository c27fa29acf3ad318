"""Published cases with proven answers: pairs of bodies in free flight, and when they begin to touch."""
