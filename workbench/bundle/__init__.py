"""Policy bundles: one file with all that is needed to run a policy, on hardware or virtual hardware."""

from .approval import objections
from .bundle import ObservationEntry, PolicyBundle, read_bundle, write_bundle
from .policy import Policy

__all__ = [
    "ObservationEntry", "Policy", "PolicyBundle", "objections", "read_bundle", "write_bundle",
]  # fmt: skip
