"""Which pairs can touch: a file a scheme (`grid`, `sap`), kernels only, and what they share."""
