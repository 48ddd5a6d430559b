"""The verbs of the library: read, check, evaluate, optimise, sensitivity, seal, report, save."""

from .actuator import Actuator, check, read
from .optimum import evaluate, optimise, sensitivity
from .reports import date_from_environment, report, save
from .seals import seal, with_contact, write_seal

__all__ = [
    "Actuator",
    "check",
    "date_from_environment",
    "evaluate",
    "optimise",
    "read",
    "report",
    "save",
    "seal",
    "sensitivity",
    "with_contact",
    "write_seal",
]
