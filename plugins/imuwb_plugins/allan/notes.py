"""Notes of the Allan analysis: what a reader of the curves must know."""

from collections.abc import Iterator, Mapping

from imuwb.axes import Axis
from imuwb.health import Doubts
from imuwb.notes import Note
from imuwb.sampling import Sampling
from imuwb.texts import counted
from imuwb_plugins.allan.result import AllanAxis

FAST = Note(
    "fast",
    "fast mode: at averaging times of 32 samples and more the sums are thinned and the times are rounded. The error of a deviation is "
    "less than a quarter of the half width of its interval. Quantization noise loses most and gets wider intervals instead.",
)
JITTER = 0.2  #: share of the sampling interval; a note reports time stamps that scatter by more
UNEXPLAINED = 1e-3  #: probability of the misfit, below which the sum does not explain the curve
SHORTENED = 1.5  #: ratio of the first averaging time of a fit to the sampling interval, above which a note names it


def notes_of(
    axes: Mapping[str, Axis], doubts: Doubts, results: Mapping[str, AllanAxis], *, fast: bool
) -> Iterator[Note]:
    """Yield the notes of a log's IMU."""
    yield from doubts.all
    if fast:
        yield FAST
    for sensor, clock in {axis.sensor: axis.clock for axis in axes.values()}.items():
        yield from _clock_notes(sensor, clock)
    for name, result in results.items():
        if result.why_no_fit:
            yield Note("no-fit", f"{name}: {result.why_no_fit}")
    yield from _fit_notes(axes, results)


def _clock_notes(sensor: str, clock: Sampling) -> Iterator[Note]:
    if clock.breaks:
        yield Note(
            "gaps",
            f"{sensor}: {counted(len(clock.breaks), 'gap')}, {clock.missing:.3g} s in total. At averaging times where the gaps leave too few "
            "differences, block means bridge them. Lines, likelihood and wavelet variances use the longest part without gaps, if "
            "that is half of the record or more.",
        )
    if clock.jitter > JITTER:
        yield Note(
            "jitter",
            f"{sensor}: time stamps scatter by {100 * clock.jitter:.0f} % of the sampling interval; the samples are taken as even at "
            f"{1 / clock.interval:.4g} Hz, so do not trust averaging times near one interval",
        )


def _fit_notes(axes: Mapping[str, Axis], results: Mapping[str, AllanAxis]) -> Iterator[Note]:
    shortened: dict[float, list[str]] = {}
    for name, result in results.items():
        fit = result.fit
        if fit is None:
            continue
        if fit.from_averaging_time > SHORTENED * axes[name].clock.interval:
            shortened.setdefault(fit.from_averaging_time, []).append(name)
        if fit.probability < UNEXPLAINED:
            yield Note(
                "unexplained",
                f"{name}: the sum does not explain the curve (chi-square per degree of freedom {fit.misfit:.2g}), so the intervals "
                f"are wider by a factor of {fit.misfit**0.5:.2g}",
            )
    for shortest, names in shortened.items():
        yield Note(
            "shortened",
            f"{', '.join(names)}: the fit begins at {shortest:.3g} s, because no sum of these processes explains shorter averaging "
            "times (the sensor's own filter, or lines)",
        )
