"""Samples before and after the correction by the calibrated model, thinned for figures."""

from collections.abc import Sequence

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.calibration import RateRun
from imuwb.stochastic import ImuErrorModel, corrected, unscaled
from imuwb_plugins.calibration.result import Trace
from imuwb_plugins.calibration.stretches import SteadyStretch

POSITION_POINTS = 400  #: most samples of a position
STEP_POINTS = 200  #: most samples of a step


def position_traces(
    stretches: Sequence[SteadyStretch], force: Floats, model: ImuErrorModel, *, with_gyro: bool
) -> list[Trace]:
    """Return a trace of each accelerometer where its axis points up most, and of each gyro over all positions.

    Args:
        stretches: the P positions.
        force: (P, 3) m/s², true specific force.
        model: the calibrated model.
        with_gyro: whether the gyros are calibrated.
    """
    thin: list[tuple[Floats, Floats, Floats]] = []
    for s in stretches:
        assert s.accel is not None  # noqa: S101 - every position has accelerometer samples
        rows = np.linspace(0, len(s.accel) - 1, min(POSITION_POINTS, len(s.accel))).astype(int)
        still = np.zeros((1, 3)) if s.gyro is None else s.gyro
        gyro = still[np.linspace(0, len(still) - 1, rows.size).astype(int)]
        thin.append((np.linspace(0, s.seconds, rows.size), s.accel[rows], gyro))
    after = [corrected(model, (gyro, accel), None) for _, accel, gyro in thin]
    traces: list[Trace] = []
    for k in range(3):
        at = int(np.argmax(force[:, k]))
        x, accel, _ = thin[at]
        title = f"Accelerometer {'xyz'[k]}, {stretches[at].name}"
        traces.append(Trace(title, x, accel[:, k], after[at][1][:, k], np.full(x.size, force[at, k])))
    if with_gyro:
        start = np.cumsum([0.0, *(s.seconds for s in stretches[:-1])])
        x = np.concatenate([t + begin for (t, *_), begin in zip(thin, start, strict=True)])
        for k in range(3):
            raw, clean = (np.concatenate(part) for part in ([t[2][:, k] for t in thin], [a[0][:, k] for a in after]))
            title = f"Gyro {'xyz'[k]}, all positions in sequence"
            traces.append(Trace(title, x, raw, clean, np.zeros(x.size), f"gyro_{'xyz'[k]}" not in unscaled(model)))
    return traces


def table_trace(
    stretches: Sequence[SteadyStretch], run: RateRun, force: Floats | None, model: ImuErrorModel, raw: str
) -> Trace:
    """Return a trace of the turned gyro over its steps in sequence."""
    axis, gyros, forces, times, wanted = run.axis, [], [], [], []
    start = 0.0
    for i, s in enumerate(stretches):
        assert s.gyro is not None  # noqa: S101 - every step has gyro samples
        rows = np.linspace(0, len(s.gyro) - 1, min(STEP_POINTS, len(s.gyro))).astype(int)
        gyros.append(s.gyro[rows])
        forces.append(np.broadcast_to(np.zeros(3) if force is None else force[i], (rows.size, 3)))
        times.append(start + np.linspace(0, s.seconds, rows.size))
        wanted.append(np.full(rows.size, run.rate[i]))
        start += s.seconds
    gyro = np.concatenate(gyros)
    # The specific force is corrected already; only the gyros' terms remain to be corrected.
    only = ImuErrorModel(model.name, {a: m for a, m in model.axes.items() if a.startswith("gyro")})
    clean, _ = corrected(only, (gyro, np.concatenate(forces)), None)
    unit = f", {raw}" if raw else ""
    return Trace(
        f"Gyro {'xyz'[axis]} in {stretches[0].name.rsplit(' ', 2)[0]}{unit}", np.concatenate(times), gyro[:, axis], clean[:, axis],
        np.concatenate(wanted),
    )  # fmt: skip
