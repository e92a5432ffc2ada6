"""What `all.py` measures: each part gives rows of ratios."""
