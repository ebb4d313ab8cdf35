"""From a log to the least-squares spectra of its axes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from imuwb.analysis import Finding
from imuwb.arrays import Floats
from imuwb.axes import Axis, axes_of, for_each
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.lssa import Constituents, Noise
from imuwb.log import SECOND, Log
from imuwb.noise_results import missing_notes
from imuwb.notes import Note
from imuwb_plugins.lssa.axis import axis_result
from imuwb_plugins.lssa.parameters import Parameters
from imuwb_plugins.lssa.result import LssaAxis, Result


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the spectra of the log's IMU.

    Raises:
        MissingDataError: no axis has a spectrum, or a known line has less than one cycle in the record.
        UsageError: a file without a covariance.
    """
    log = logs[0]
    imu = log.imu()
    axes = axes_of(imu)
    constituents = Constituents(parameters.trend, parameters.jumps, parameters.forced, parameters.exponentials)
    option = parameters.noise
    covariance = None if option.file is None else _covariance(option.file)
    noise = Noise(option.kind, option.order, option.correlation_time, covariance)
    _check_forced(log, axes, constituents)
    results = for_each(axes, lambda axis: axis_result(axis, parameters, constituents, noise, log.zero or 0, log.band))
    notes = missing_notes(log, {name: r.why_none for name, r in results.items()}, "no-spectrum", "a spectrum")
    notes += _band_notes(results, parameters)
    return Result(
        imu.name, parameters.level, parameters.confidence, str(parameters.noise), parameters.scale, results, tuple(notes)
    )  # fmt: skip


def _covariance(path: Path) -> Floats:
    try:
        covariance = np.asarray(np.load(path, allow_pickle=False)).astype(float, casting="same_kind")
    except (OSError, EOFError, ValueError, TypeError) as error:
        raise UsageError(
            f"--noise covariance:{path}: it cannot be read; the file must be one array of numbers (.npy): {error}"
        ) from error
    if covariance.ndim != 2:  # noqa: PLR2004 - rows and columns
        raise UsageError(
            f"--noise covariance:{path}: an array of shape {covariance.shape}; a covariance must be square, n x n"
        )
    return covariance


def _check_forced(log: Log, axes: dict[str, Axis], constituents: Constituents) -> None:
    """Raise MissingDataError if the record holds less than one cycle of a known line."""
    for axis in axes.values():
        span = float(axis.time[-1] - axis.time[0]) / SECOND
        for frequency in constituents.forced:
            if frequency * span < 1:
                raise MissingDataError(
                    f"{log.provenance.path}: --forced {frequency:g}: its period is {1 / frequency:g} s, but {axis.sensor} has "
                    f"{span:g} s; the record must hold at least one period; use --trend quadratic for a slower drift"
                )


def _band_notes(results: dict[str, LssaAxis], parameters: Parameters) -> list[Note]:
    notes: dict[str, Note] = {}
    for name, r in results.items():
        sensor = name.partition("_")[0]
        if r.why_none is not None or sensor in notes:
            continue
        text = f"{sensor}: the spacing of the samples distinguishes lines from {r.lowest:.3g} to {r.highest:.5g} Hz"
        if r.mirror is not None:
            text += f"; a line at f also shows at {r.mirror:.5g} Hz - f"
        limited = parameters.highest is not None and parameters.highest > r.highest * (1 + 1e-9)
        if limited:
            text += f"; the frequencies from there to --highest {parameters.highest:g} Hz are not searched"
        notes[sensor] = Note("band-limited" if limited else "band", text)
    return list(notes.values())


def findings(result: Result) -> tuple[Finding, ...]:
    """Return the claimed lines of each axis."""
    remarks: list[Finding] = []
    for axis, r in result.axes.items():
        lines = [p for p in r.peaks if p.claimed]
        remark = f"line{'s' if len(lines) > 1 else ''} at {', '.join(p.name for p in lines[:3])}" if lines else ""
        remarks.append(Finding(axis, "lssa", {}, (remark,) if remark else ()))
    return tuple(remarks)
