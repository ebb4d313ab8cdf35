"""What is wrong with a log, stream by stream: where, how often, how badly, and what follows from it."""

from imuwb.health.check import Health, StreamHealth, check, is_of
from imuwb.health.fault import Fault

__all__ = ["Fault", "Health", "StreamHealth", "check", "is_of"]
