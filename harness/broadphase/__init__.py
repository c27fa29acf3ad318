"""Which pairs can touch: all pairs, uniform and hierarchical grid."""
