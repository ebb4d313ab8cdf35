"""``--temperature`` as one writes it: one figure, from one to another, or corner points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.errors import UsageError

if TYPE_CHECKING:
    from imuwb.simulation import Temperature

LEAST = 1.0  #: s, of a ramp


def temperature_of(text: str | None, duration: float) -> Temperature | float | None:
    """Return what a text says of a sensor's temperature.

    Args:
        text: ``25`` all the while, ``-40:70`` from the log's start to its end, ``0:-30,600:-30,1200:45`` s:°C, linear between.
        duration: s, of the log.

    Raises:
        UsageError: another text, or temperatures that cannot be; the message names the option.
    """
    from imuwb.simulation import Temperature  # noqa: PLC0415 - help must not wait for numpy

    if text is None:
        return None
    rows = [part.split(":") for part in text.split(",")]
    try:
        numbers = [tuple(float(figure) for figure in row) for row in rows]
    except ValueError:
        numbers = []
    shape = {len(row) for row in numbers}
    try:
        if shape == {1} and len(numbers) == 1:
            return numbers[0][0]
        if shape == {2}:
            pairs = [(a, b) for a, b in numbers]
            return Temperature.ramp(*pairs[0], max(duration, LEAST)) if len(pairs) == 1 else Temperature(tuple(pairs))
    except UsageError as error:
        message = f"--temperature {text!r}: {error}"
        raise UsageError(message) from error
    message = (
        f"--temperature {text!r}: write 25 (°C all the while), -40:70 (from the start to the end), "
        "or 0:-30,600:-30,1200:45 (s:°C, linear between)"
    )
    raise UsageError(message)
