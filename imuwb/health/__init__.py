"""Checks what is wrong with each stream of a log: where, how often, how badly, and with which consequence."""

from imuwb.health.check import Health, StreamHealth, check, is_of
from imuwb.health.fault import Fault

__all__ = ["Fault", "Health", "StreamHealth", "check", "is_of"]
