"""Checks what is wrong with each stream of a log: where, how often, how badly, and with which consequence."""

from imuwb.health.check import Health, StreamHealth, check, is_of
from imuwb.health.fault import Fault
from imuwb.health.fault_text import fault_texts
from imuwb.health.still_record import Doubts, model_doubts, record_doubts, stillness_of
from imuwb.health.thermometer import sound_thermometer

__all__ = [
    "Doubts", "Fault", "Health", "StreamHealth", "check", "fault_texts", "is_of", "model_doubts", "record_doubts",
    "sound_thermometer", "stillness_of",
]  # fmt: skip
