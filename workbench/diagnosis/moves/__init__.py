"""Moves of the search: what may be tried next from a node (add, replace, merge, simplify, restart)."""
