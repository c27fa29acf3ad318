"""Two bodies, or a body and a wall: do they touch, how far apart are they, when do they meet. Kernels only."""
