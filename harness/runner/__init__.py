"""One run in one process; a sweep of them."""
