"""Error against run time: what each method costs at each error, and what to use."""
