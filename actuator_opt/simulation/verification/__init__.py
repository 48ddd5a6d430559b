"""Verification of dynamic requirements by separate experiments in time."""

from .verify import DYNAMIC, Verification, VerifiedRequirement, verify

__all__ = ["DYNAMIC", "Verification", "VerifiedRequirement", "verify"]
