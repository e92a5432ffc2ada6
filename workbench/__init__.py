"""workbench: compare a robot model with measurements, find what is missing, add it, watch the error fall."""
