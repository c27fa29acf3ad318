"""Which methods survive stiff and extreme cases, which degrade, fail or refuse."""
