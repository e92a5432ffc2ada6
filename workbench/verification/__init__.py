"""Whether the closed chain, the serial tree and S3N agree: Drake, Pinocchio, MuJoCo and the closed forms."""

from .verify import verify

__all__ = ["verify"]
