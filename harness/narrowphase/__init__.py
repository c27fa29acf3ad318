"""Two bodies, or a body and a wall: do they touch, and how deep."""
