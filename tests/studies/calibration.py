"""Test the coverage of calibrated parameters, and the noise of a record that is corrected by them.

Each record is another MPU-6050: biases, scale factors, non-linear parts, cross-couplings and g-sensitivities are drawn within the
tolerances of the data sheet. The sensor stands on the six faces of a cube for 1 min each at 50 Hz (faces tilted by 0.05° rms, latitude
45°, random headings), and in 15 positions of known and of unknown attitudes for 30 s each. It turns on a rate table about each axis at
10, 50 and 100 deg/s in both directions, 20 s a step (mounted with a tilt of 0.05° rms). The plugin finds and orders the positions and
the steps. Goals: 93 to 97 % of all parameters are inside their 95 % intervals, and each single parameter is in at least 90 %.

The record with z up is then corrected by the results of the six-position method and of the rate table, as --through correction does.
The corrected record must have the sensor's own noise and spectrum.

The last table shows other conditions: faces without tilt, faces with ten times the tilt, and a sensor with slow noise (3dm-gx3-25: flicker,
and a random walk on the accelerometers). The true bias of the last is the mean over the six minutes, slow noise included.

Definition of a true parameter: with one value of gravity, the scale factor contains the non-linear part, s + s2 g/range. Without attitudes,
the frame is defined by the x accelerometer, so the true matrix is rotated until it is lower triangular.

Command: ``python tests/studies/calibration.py`` (300 records: about 6 minutes on 2 cores).
Seeds: seed r draws the sensor, the bench and the noise of record r.
"""

from __future__ import annotations

import tempfile
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np
from study_report import Mean, Share, Table, main, over_records, pooled, verdict

from imuwb import simulation
from imuwb.geodesy.earth import gravity
from imuwb.identification import allan, fit_allan, power_spectrum
from imuwb.log import AXES
from imuwb.stochastic import Sum, WhiteNoise
from imuwb_plugins import correction
from imuwb_plugins.calibration import METHODS

QUESTION = "Calibration of a simulated MPU-6050: coverage of the intervals"
RATES, LATITUDE, TILT = (10.0, 50.0, 100.0), 45.0, 0.05
RATE, MINUTES, SECONDS, POSITIONS = 50.0, 1.0, 20.0, 15
CONDITIONS = {
    "faces without tilt": ("mpu-6050", 0.0),
    "faces tilted by 0.5° rms": ("mpu-6050", 0.5),
    "slow noise (3dm-gx3-25)": ("3dm-gx3-25", TILT),
}
BLOCK = 10  #: records of one job
LEVEL, RANGE = 0.95, 2.0  #: g
SPLIT = 2.0  #: Hz, limit between the two bands of the spectrum
POOLED, EACH = (0.93, 0.97), 0.90


def site():
    """Return gravity and latitude of the bench."""
    angle = np.radians(LATITUDE)
    return simulation.Site(float(gravity(np.array([angle]), np.zeros(1))[0]), float(angle))


def calibrate(method, logs, **options):
    """Return the result of a method of the calibration plugin; each log is named by its key."""
    module = METHODS[method]
    logs = [replace(log, provenance=replace(log.provenance, path=name)) for name, log in logs.items()]
    return module.run(logs, module.Parameters(latitude=LATITUDE, level=LEVEL, **options))


def truth(model, method):
    """Return {(axis, parameter): value}, as a method defines the parameters."""
    values, g = {}, site().gravity
    for axis, terms in model.axes.items():
        values[axis, "bias"] = terms.bias
        bend = terms.scale_factor_nonlinear
        one_gravity = axis.startswith("accel") and method == "six-position" and terms.range
        values[axis, "scale_factor"] = terms.scale_factor + (bend * g / terms.range if one_gravity else 0.0)
        values[axis, "scale_factor_nonlinear"] = bend
        for other, c in zip([k for k in "xyz" if k != axis[-1]], terms.cross_coupling, strict=True):
            values[axis, f"cross_coupling_{other}"] = c
        if axis.startswith("gyro"):
            values |= {(axis, f"g_sensitivity_{k}"): v for k, v in zip("xyz", terms.g_sensitivity, strict=True)}
    if method == "no attitudes":
        lower = lower_triangular(matrix(model, "accel"))
        for i, axis in enumerate(AXES[3:]):
            values[axis, "scale_factor"] = lower[i, i] - 1
            values |= {(axis, f"cross_coupling_{'xyz'[j]}"): lower[i, j] for j in range(i)}
        turned = np.linalg.solve(lower, matrix(model, "accel"))
        for axis in AXES[:3]:
            leak = turned @ np.array(model.axes[axis].g_sensitivity)
            values |= {(axis, f"g_sensitivity_{k}"): float(v) for k, v in zip("xyz", leak, strict=True)}
    return values


def matrix(model, sensor):
    """Return the (3, 3) matrix of scale factors and cross-couplings of the gyros or the accelerometers."""
    rows = []
    for i, k in enumerate("xyz"):
        terms = model.axes[f"{sensor}_{k}"]
        rows.append(np.insert(np.array(terms.cross_coupling), i, 1 + terms.scale_factor))
    return np.stack(rows)


def lower_triangular(whole):
    """Return L of whole = L Q with a rotation Q."""
    q, r = np.linalg.qr(whole.T)
    signs = np.sign(np.diag(r))
    del q
    return (r * signs[:, None]).T


def straight(model):
    """Return the model without non-linear parts, which the fit without attitudes does not estimate."""
    return replace(model, axes={k: replace(a, scale_factor_nonlinear=0.0) for k, a in model.axes.items()})


def coverage(result, true, method):
    """Return (method, axis, parameter, whether the interval contains the truth) of every parameter."""
    return [
        (method, axis, name, bool(p.lower <= true[axis, name] <= p.upper))
        for axis, parameters in result.parameters.items()
        for name, p in parameters.items()
    ]


def record(seed):
    """Return (method, axis, parameter, inside) of all methods, and the noise of the corrected record by axis."""
    model = simulation.specimen(simulation.preset("mpu-6050"), seed, simulation.Tolerances())
    tilt = float(np.radians(TILT))
    cube = simulation.six_position(model, seed, seconds=60 * MINUTES, rate=RATE, misplacement=tilt, site=site())
    six = calibrate("six-position", cube.logs)
    table = simulation.rate_table(
        model, seed, np.radians(RATES), seconds=SECONDS, rate=RATE, misplacement=tilt, site=site()
    )
    turned = calibrate("rate-table", table.logs, rates=RATES, misplacement=TILT)
    rows = coverage(six, truth(model, "six-position"), "six-position")
    rows += coverage(turned, truth(model, ""), "rate-table")
    with tempfile.TemporaryDirectory() as folder:
        positions = simulation.six_position(
            model, seed, positions=POSITIONS, seconds=30 * MINUTES, rate=RATE, misplacement=tilt, site=site()
        )
        path = Path(folder) / "attitudes.txt"
        text = "\n".join(f"{a:.9f},{b:.9f}" for a, b in np.degrees(positions.attitudes))
        path.write_text(f"roll_deg,pitch_deg\n{text}\n", "utf-8")
        known = calibrate("multi-position", positions.logs, attitudes=path, range=RANGE)
        rows += coverage(known, truth(model, ""), "multi-position, attitudes known")
        plain = straight(model)
        free = simulation.six_position(plain, seed, positions=POSITIONS, seconds=30 * MINUTES, rate=RATE, site=site())
        unknown = calibrate("multi-position", free.logs)
        rows += coverage(unknown, truth(plain, "no attitudes"), "multi-position, attitudes unknown")
        base = Path(folder) / "six.toml"
        base.write_text(six.model.to_toml(), "utf-8")
        both = calibrate("rate-table", table.logs, rates=RATES, misplacement=TILT, into=base).model
        noise = corrected_noise(model, both, cube.logs["up_z"], Path(folder))
    return rows, noise


def corrected_noise(model, calibrated, log, folder):
    """Return (axis, whether the interval of N contains the true N, N and two densities over the true values) of a corrected record."""
    path = folder / "both.toml"
    path.write_text(calibrated.to_toml(), "utf-8")
    clean, _ = correction.condition(log, correction.Parameters(path))
    rows = []
    for axis, (_, values) in clean.imu().axes().items():
        white = next(t.N for t in model.axes[axis].processes.terms if isinstance(t, WhiteNoise))
        # The sensor adds its noise after the scale factor, so the correction divides the noise by the scale factor.
        true = white / (1 + model.axes[axis].scale_factor)
        n = fit_allan(allan(values, 1 / RATE, level=LEVEL)).coefficients["N"]
        spectrum = power_spectrum(values, 1 / RATE)
        ratio = spectrum.density / (2 * true**2)  # one-sided
        weight = spectrum.degrees_of_freedom
        bands = [
            float(np.average(ratio[part], weights=weight[part]))
            for part in (spectrum.frequency <= SPLIT, spectrum.frequency > SPLIT)
        ]
        rows.append((axis, n.lower is not None and n.lower <= true <= n.upper, (n.value or 0.0) / true, *bands))
    return rows


def other_conditions(seed):
    """Return (condition, sensor, kind of parameter, inside) of the six-position method in other conditions."""
    rows = []
    for condition, (name, tilt) in CONDITIONS.items():
        model = simulation.specimen(simulation.preset(name), seed, simulation.Tolerances())
        quiet = replace(model, axes={k: replace(a, processes=Sum()) for k, a in model.axes.items()})
        cube, still = (
            simulation.six_position(
                m, seed, seconds=60 * MINUTES, rate=RATE, misplacement=float(np.radians(tilt)), site=site()
            )
            for m in (model, quiet)
        )
        true = truth(model, "six-position")
        for axis in AXES:  # slow noise is part of the true bias
            pairs = (
                (noisy.imu().axes()[axis][1], still.logs[k].imu().axes()[axis][1]) for k, noisy in cube.logs.items()
            )
            true[axis, "bias"] += float(np.mean([(a - b).mean() for a, b in pairs]))
        for _, axis, parameter, inside in coverage(calibrate("six-position", cube.logs), true, ""):
            rows.append((condition, axis[:-2], parameter.removesuffix(f"_{parameter[-1]}"), inside))
    return rows


def block(first, last):
    """Return the figures of some records: (coverage, noise of the corrected record, coverage in other conditions)."""
    return [(*record(seed), other_conditions(seed)) for seed in range(first, last)]


def study(records=300, workers=2):
    """Return the tables: a summary, the corrected record, the parameters by method, other conditions."""
    jobs = [(first, min(first + BLOCK, records)) for first in range(0, records, BLOCK)]
    done = [record for part in over_records(block, jobs, workers) for record in part]
    counts = defaultdict(list)
    for rows, *_ in done:
        for method, axis, name, inside in rows:
            counts[method, axis, name].append(inside)
    shares = {key: Share(sum(c), len(c)) for key, c in counts.items()}
    methods = list(dict.fromkeys(key[0] for key in shares))
    tables = (_summary(shares, methods), _noise(done), *(_parameters(shares, method) for method in methods))
    return (*tables, _conditions(done))


def _conditions(done):
    counts = defaultdict(list)
    for *_, rows in done:
        for condition, sensor, kind, inside in rows:
            counts[condition, sensor, kind].append(inside)
    kinds = list(dict.fromkeys(key[1:] for key in counts))
    rows = tuple(
        (condition, *(str(Share(sum(c), len(c))) for c in (counts[condition, *kind] for kind in kinds)))
        for condition in CONDITIONS
    )
    headings = ("condition", *(f"{sensor} {kind}" for sensor, kind in kinds))
    note = (
        "Pooled over axes. The true bias is the mean over all positions, slow noise included. On a cube without tilt the intervals are too "
        "wide, because six residuals cannot show that there is no tilt. A random walk changes an accelerometer's bias between its own two upright "
        "positions and the others by more than the noise within a position shows: the interval of the bias is too narrow there, and the result "
        "has a note on slow noise."
    )
    return Table("Six-position method in other conditions", headings, rows, note)


def _summary(shares, methods):
    rows = []
    for method in methods:
        own = {key: s for key, s in shares.items() if key[0] == method}
        together = pooled(own.values())
        worst = min(own, key=lambda key: own[key].value)
        ok = POOLED[0] <= together.value <= POOLED[1] and own[worst].value >= EACH
        rows.append((method, len(own), together, f"{own[worst]}, {worst[1]} {worst[2]}", verdict(ok)))
    goal = "goal: 93 to 97 % pooled, each at least 90 %"
    headings = ("method", "parameters", "coverage, pooled", "parameter of the lowest coverage", goal)
    return Table("Goals", headings, tuple(rows))


def _noise(done):
    by_axis = defaultdict(list)
    for _, noise, _ in done:
        for axis, inside, *ratios in noise:
            by_axis[axis].append((inside, *ratios))
    rows = [(axis, *_row(records)) for axis, records in by_axis.items()]
    rows.append(("all", *_row([record for records in by_axis.values() for record in records])))
    note = (
        "The record with z up is corrected by the results of the six-position method and of the rate table. N is estimated from the Allan "
        "deviation; the true N is the model's N over 1 + s, because noise is added after the scale factor. The density of the Welch spectrum is "
        "compared with 2 N². Means with their standard errors."
    )
    headings = (
        "axis", "coverage of N by its 95 % interval", "N / true N", f"density / true, to {SPLIT:g} Hz", f"density / true, above {SPLIT:g} Hz",
    )  # fmt: skip
    return Table("Noise of the corrected record", headings, tuple(rows), note)


def _row(records):
    inside, *ratios = (np.array(part, dtype=float) for part in zip(*records, strict=True))
    means = (Mean(float(r.mean()), float(r.std(ddof=1)) / len(r) ** 0.5) for r in ratios)
    return Share(int(inside.sum()), len(inside)), *means


def _parameters(shares, method):
    own = {key[1:]: s for key, s in shares.items() if key[0] == method}
    names = list(dict.fromkeys(name for _, name in own))
    axes = [axis for axis in AXES if any(key[0] == axis for key in own)]
    rows = tuple((name, *(str(own[axis, name]) if (axis, name) in own else "–" for axis in axes)) for name in names)
    return Table(f"Coverage of the 95 % interval: {method}", ("parameter", *axes), rows)


if __name__ == "__main__":
    main(__file__, QUESTION, study, 300, lambda n: f"seeds 0..{n - 1}; n = {n} sensors")
