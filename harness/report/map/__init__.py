"""A map of who is fastest where: cells over two leaves, each won by a method or by none."""
