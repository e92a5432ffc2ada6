"""The machines' own simulator, which shares no code with any solver; and the cases that it makes."""
