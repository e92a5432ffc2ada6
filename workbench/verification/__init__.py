"""Whether the closed chain, the serial tree and S3N agree."""
