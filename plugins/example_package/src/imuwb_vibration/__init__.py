"""Vibration: root mean square of each axis by band of frequency, with intervals, and the strongest line of each band.

The log is cut into segments of equal length, without gaps inside. Each gives the power of each band; the result is their mean, and its
interval comes from how much the segments differ (Student's t), so that it also holds for vibration that changes.

Example: imuwb vibration flight.bin --edges 1,5,20,80
"""

import lazy_loader

# The public names are in __init__.pyi; each is imported when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
