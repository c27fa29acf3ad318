"""What is true, and how wrong a run was: exact contacts of a motion, and what was reported held against them."""
