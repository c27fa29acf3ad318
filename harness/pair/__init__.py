"""Two bodies, asked about from Python: do they touch, how far apart are they, when do they meet."""
