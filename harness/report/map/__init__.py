"""A map of who is fastest where: fields over two leaves, each won by a method or by none."""
