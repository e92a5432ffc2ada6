"""The closed chain in Drake: the reference dynamics."""
