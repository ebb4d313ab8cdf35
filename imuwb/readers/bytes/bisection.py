"""Finds the places of a time in a file whose times rise, by looking at a few of them."""

from collections.abc import Callable, Mapping


def bracket(
    known: Mapping[int, int], time_at: Callable[[int], int], time: int, size: int, fine: int
) -> tuple[int, int]:
    """Return two places at most ``fine`` bytes apart: before the second and not before the first, the time is reached.

    Args:
        known: place -> time of some places all over the file.
        time_at: returns the time of a place.
        time: to be found.
        size: bytes of the file.
        fine: bytes.
    """
    low = max((place for place, at in known.items() if at < time), default=0)
    high = min((place for place, at in known.items() if at >= time and place > low), default=size)
    while high - low > fine:
        middle = (low + high) // 2
        low, high = (middle, high) if time_at(middle) < time else (low, middle)
    return low, high
