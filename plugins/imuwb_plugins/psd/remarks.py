"""Remarks on the spectrum of an axis."""

from collections.abc import Iterator

import numpy as np

from imuwb.analysis import Finding
from imuwb.notes import Note
from imuwb_plugins.psd.result import Result, SpectrumAxis

NAMED = 3  #: lines that a remark names, the strongest


def findings(result: Result) -> tuple[Finding, ...]:
    """Return the coefficients of each axis, with remarks on what is not white noise."""
    return tuple(Finding(axis, "psd", r.coefficients, tuple(_remarks(r))) for axis, r in result.axes.items())


def _remarks(r: SpectrumAxis) -> Iterator[Note]:
    if r.white_to is not None:
        how = "falls below" if r.excess < 1 else "rises above"
        ratio = f"{abs(10 * np.log10(r.excess)):.1f} dB"
        yield Note("not-white", f"not white above {r.white_to:.3g} Hz: the spectrum {how} its white level by {ratio}")
    if r.resonances:
        yield Note("resonance", f"resonance near {', '.join(f'{f:.3g}' for f in r.resonances)} Hz")
    if r.lines:
        names = ", ".join(line.name.removeprefix("line at ") for line in r.lines[:NAMED])
        more = f" and {len(r.lines) - NAMED} more" if len(r.lines) > NAMED else ""
        yield Note("lines", f"line{'s' if len(r.lines) > 1 else ''} at {names}{more}")
