"""Dynamic requirements checked in time, each by an experiment of its own."""

from .verify import DYNAMIC, Verification, VerifiedRequirement, verify

__all__ = ["DYNAMIC", "Verification", "VerifiedRequirement", "verify"]
