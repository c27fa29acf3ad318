"""Complete detectors behind one protocol, a file each."""
