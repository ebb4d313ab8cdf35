"""The test that a series passes before any noise analysis."""

from imuwb.arrays import Floats

LARGEST = 1e12  #: rad/s or m/s²; no sensor gives more


def unsuitable(values: Floats, fewest: int) -> str | None:
    """Return why a series cannot be analysed; None where it can."""
    if values.size < fewest:
        return f"the longest part without gaps has {values.size} samples; the analysis needs at least {fewest}"
    lowest, highest = float(values.min()), float(values.max())
    if lowest == highest:
        return "the channel is constant; it is stuck or not connected"
    if (most := max(-lowest, highest)) > LARGEST:
        return f"one value is {most:.3g}; no sensor gives so much; exclude its time with --start and --end"
    return None
