"""What flies: meshes with their hulls and bounding spheres, bodies as arrays, the box, and the launch."""
