"""What may be tried next from a node of the search: effects to add, replace, merge, simplify; restarts."""
