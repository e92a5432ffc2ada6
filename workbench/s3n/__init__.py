"""S3N: the paper's closed forms, every variant as a runnable model, and the normalised MJCF."""
