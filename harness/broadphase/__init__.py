"""Which pairs can touch: a file a scheme (`brute_force`, `grid`, `sap`), kernels only, and what they share."""
