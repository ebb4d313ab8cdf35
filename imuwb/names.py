"""Names of streams and logs for people: those that are alike together, and long ones without what they share."""

import re
from collections.abc import Iterable, Sequence
from itertools import takewhile

CUT = "…"
NUMBER = "\0"  #: stands for the number in names that are alike


def shortened(text: str, width: int) -> str:
    """Return a text of at most so many columns, without its middle, because names differ at their ends."""
    if len(text) <= width:
        return text
    end = (width - 1) * 2 // 3
    return f"{text[: width - 1 - end]}{CUT}{text[len(text) - end :]}"


def distinct(names: Sequence[str], width: int) -> tuple[str, ...]:
    """Return names of at most so many columns. Where they are longer, what all of them share is shortened first.

    Names that differ still differ, unless more than ``width`` columns of them do.
    """
    if all(len(name) <= width for name in names) or len(set(names)) < 2:  # noqa: PLR2004 - one has nothing to differ from
        return tuple(shortened(name, width) for name in names)
    begin = _shared(names)
    rest = [name[len(begin) :] for name in names]
    end = _shared([text[::-1] for text in rest])[::-1]
    own = [text[: len(text) - len(end)] for text in rest]
    left = max(width - max(map(len, own)), 0)
    end = _last(end, max(left // 2, left - len(begin)))
    begin = _first(begin, left - len(end))
    return tuple(shortened(f"{begin}{text}{end}", width) for text in own)


def _shared(texts: Sequence[str]) -> str:
    """Return the letters with which all texts begin."""
    return "".join(letters[0] for letters in takewhile(lambda own: len(set(own)) == 1, zip(*texts, strict=False)))


def _first(text: str, width: int) -> str:
    return text if len(text) <= width else f"{text[: max(width - 1, 0)]}{CUT}"[:width]


def _last(text: str, width: int) -> str:
    return text if len(text) <= width else f"{CUT}{text[len(text) - width + 1 :]}" if width > 1 else CUT[:width]


def alike(names: Iterable[str]) -> tuple[str, ...]:
    """Return names in which those that differ in a number alone are one: IMU.0, IMU.1, IMU.2 are IMU.0-2.

    A number that a name has several times counts as one: sensor_accel.1+sensor_gyro.1.
    """
    groups: dict[str, list[int]] = {}
    for name in dict.fromkeys(names):
        numbers = re.findall(r"\d+", name)
        last = numbers[-1] if numbers and str(int(numbers[-1])) == numbers[-1] else ""
        shape = re.sub(rf"(?<!\d){last}(?!\d)", NUMBER, name) if last else name
        groups.setdefault(shape, []).append(int(last or 0))
    return tuple(shape.replace(NUMBER, _ranges(sorted(set(own)))) for shape, own in groups.items())


def listed(names: Iterable[str], width: int) -> str:
    """Return as many names as fit into so many columns, alike ones together, and how many more there are."""
    together = alike(names)
    for count in range(len(together), 0, -1):
        more = f" and {len(together) - count} more" if count < len(together) else ""
        text = ", ".join(together[:count]) + more
        if len(text) <= width:
            return text
    more = f" and {len(together) - 1} more" if len(together) > 1 else ""
    return shortened(together[0], max(width - len(more), 1)) + more if together else ""


def _ranges(numbers: Sequence[int]) -> str:
    """Return numbers as ranges: 0-2,5."""
    parts: list[str] = []
    start = previous = numbers[0]
    for number in (*numbers[1:], None):
        if number != previous + 1:
            dash = "-" if previous > start + 1 else ","
            parts.append(f"{start}{dash}{previous}" if previous > start else f"{start}")
            start = number if number is not None else start
        previous = number if number is not None else previous
    return ",".join(parts)
