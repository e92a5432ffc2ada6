"""Whether an effect is certain although something else is unknown."""
