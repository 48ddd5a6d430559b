"""Verify dynamic requirements by small simulated experiments, one for each requirement."""

from .verify import DYNAMIC, Verification, VerifiedRequirement, verify

__all__ = ["DYNAMIC", "Verification", "VerifiedRequirement", "verify"]
