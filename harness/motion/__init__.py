"""Time: stepped frames, predicted events, response, and the plan that leaves out what a scene does not need."""
