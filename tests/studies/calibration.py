"""Do the intervals of a calibration hold, and what is left behind it?

Each record is another MPU-6050: biases, scale factors, non-linear parts, cross-couplings and g-sensitivities drawn within the data
sheet's tolerances. It is set down on the six faces of a cube for 1 min each at 50 Hz (faces 0.05° rms off, at 45° latitude, headings at
random), in 15 positions of known and of unknown attitudes for 30 s each, and turned on a rate table at 10, 50 and 100 deg/s both ways,
20 s a step, about each axis (mounted 0.05° rms off). The plugins do the rest: they find the positions and the steps, and which is which.
Wanted: each parameter inside its 95 % interval in 93 to 97 % pooled, and none in less than 90 %.

Then the six-position's and the rate table's results together are taken off the record with z up, as --through correction does: what is
left must have the sensor's own noise and spectrum.

A last table leaves the MPU-6050 and its cube: faces that do not tilt at all, faces that tilt ten times as much, and a sensor with slow
noise (3dm-gx3-25: flicker, and a random walk on the accelerometers). There the true bias is that of the six minutes, slow noise included.

What a true parameter is: with one gravity alone the scale factor holds the non-linear part, s + s2 g/range. Without attitudes the frame is
that of the x accelerometer, so the true matrix is turned until it is lower triangular.

Command: ``python tests/studies/calibration.py`` (300 records: about 6 minutes on 2 cores).
Seeds: record r draws its sensor, its bench and its noise with seed r.
"""

from __future__ import annotations

import tempfile
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np
from study_report import Mean, Share, Table, main, over_records, verdict

from imuwb import simulation
from imuwb.geodesy.earth import gravity
from imuwb.identification import allan, fit_allan, power_spectrum
from imuwb.log import AXES
from imuwb.stochastic import Sum, WhiteNoise
from imuwb_plugins import correction
from imuwb_plugins.calibration import METHODS

QUESTION = "Calibration of a simulated MPU-6050: do the intervals hold?"
RATES, LATITUDE, TILT = (10.0, 50.0, 100.0), 45.0, 0.05
RATE, MINUTES, SECONDS, POSITIONS = 50.0, 1.0, 20.0, 15
ELSEWHERE = {
    "faces do not tilt": ("mpu-6050", 0.0),
    "faces 0.5° rms off": ("mpu-6050", 0.5),
    "slow noise (3dm-gx3-25)": ("3dm-gx3-25", TILT),
}
BLOCK = 10  #: records in a job
LEVEL, RANGE = 0.95, 2.0  #: g
SPLIT = 2.0  #: Hz, between the bands of the spectrum
POOLED, EACH = (0.93, 0.97), 0.90


def site():
    angle = np.radians(LATITUDE)
    return simulation.Site(float(gravity(np.array([angle]), np.zeros(1))[0]), float(angle))


def calibrate(method, logs, **options):
    module = METHODS[method]
    logs = [replace(log, provenance=replace(log.provenance, path=name)) for name, log in logs.items()]
    return module.run(logs, module.Parameters(latitude=LATITUDE, level=LEVEL, **options))


def truth(model, what):
    """Return {(axis, parameter): value} as a method may find it."""
    found, g = {}, site().gravity
    for axis, terms in model.axes.items():
        found[axis, "bias"] = terms.bias
        bent = terms.scale_factor_nonlinear
        one_gravity = axis.startswith("accel") and what == "six-position" and terms.range
        found[axis, "scale_factor"] = terms.scale_factor + (bent * g / terms.range if one_gravity else 0.0)
        found[axis, "scale_factor_nonlinear"] = bent
        for other, c in zip([k for k in "xyz" if k != axis[-1]], terms.cross_coupling, strict=True):
            found[axis, f"cross_coupling_{other}"] = c
        if axis.startswith("gyro"):
            found |= {(axis, f"g_sensitivity_{k}"): v for k, v in zip("xyz", terms.g_sensitivity, strict=True)}
    if what == "no attitudes":
        lower = lower_triangular(matrix(model, "accel"))
        for i, axis in enumerate(AXES[3:]):
            found[axis, "scale_factor"] = lower[i, i] - 1
            found |= {(axis, f"cross_coupling_{'xyz'[j]}"): lower[i, j] for j in range(i)}
        turned = np.linalg.solve(lower, matrix(model, "accel"))
        for axis in AXES[:3]:
            leak = turned @ np.array(model.axes[axis].g_sensitivity)
            found |= {(axis, f"g_sensitivity_{k}"): float(v) for k, v in zip("xyz", leak, strict=True)}
    return found


def matrix(model, sensor):
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
    """Return the model without non-linear parts, which the fit without attitudes does not know."""
    return replace(model, axes={k: replace(a, scale_factor_nonlinear=0.0) for k, a in model.axes.items()})


def held(result, true, method):
    return [
        (method, axis, name, bool(p.lower <= true[axis, name] <= p.upper))
        for axis, found in result.parameters.items()
        for name, p in found.items()
    ]


def record(seed):
    """Return (method, axis, parameter, inside) of all methods, and (axis, noise inside, bias inside, N over true N)."""
    model = simulation.specimen(simulation.preset("mpu-6050"), seed, simulation.Tolerances())
    tilt = float(np.radians(TILT))
    cube = simulation.six_position(model, seed, seconds=60 * MINUTES, rate=RATE, misplacement=tilt, site=site())
    six = calibrate("six-position", cube.logs)
    table = simulation.rate_table(
        model, seed, np.radians(RATES), seconds=SECONDS, rate=RATE, misplacement=tilt, site=site()
    )
    wanted = ",".join(map(str, RATES))
    turned = calibrate("rate-table", table.logs, rates=wanted, misplacement=TILT)
    rows = held(six, truth(model, "six-position"), "six-position") + held(turned, truth(model, ""), "rate-table")
    with tempfile.TemporaryDirectory() as folder:
        many = simulation.six_position(
            model, seed, positions=POSITIONS, seconds=30 * MINUTES, rate=RATE, misplacement=tilt, site=site()
        )
        path = Path(folder) / "attitudes.txt"
        text = "\n".join(f"{a:.9f},{b:.9f}" for a, b in np.degrees(many.attitudes))
        path.write_text(f"roll_deg,pitch_deg\n{text}\n", "utf-8")
        known = calibrate("multi-position", many.logs, attitudes=path, range=RANGE)
        rows += held(known, truth(model, ""), "multi-position, attitudes known")
        plain = straight(model)
        free = simulation.six_position(plain, seed, positions=POSITIONS, seconds=30 * MINUTES, rate=RATE, site=site())
        found = calibrate("multi-position", free.logs)
        rows += held(found, truth(plain, "no attitudes"), "multi-position, attitudes unknown")
        base = Path(folder) / "six.toml"
        base.write_text(six.model.to_toml(), "utf-8")
        both = calibrate("rate-table", table.logs, rates=wanted, misplacement=TILT, into=base).model
        rest = left(model, both, cube.logs["up_z"], Path(folder))
    return rows, rest


def left(model, found, log, folder):
    """Return, by axis, whether the corrected record's N interval holds the sensor's own, and N and densities over the true ones."""
    path = folder / "both.toml"
    path.write_text(found.to_toml(), "utf-8")
    clean, _ = correction.condition(log, correction.Parameters(path))
    rows = []
    for axis, (_, values) in clean.imu().axes().items():
        white = next(t.N for t in model.axes[axis].processes.terms if isinstance(t, WhiteNoise))
        # Noise comes behind the scale factor, and is divided by it.
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


def elsewhere(seed):
    """Return (condition, sensor, kind of parameter, inside) of the six-position in other conditions."""
    rows = []
    for condition, (name, tilt) in ELSEWHERE.items():
        model = simulation.specimen(simulation.preset(name), seed, simulation.Tolerances())
        quiet = replace(model, axes={k: replace(a, processes=Sum()) for k, a in model.axes.items()})
        cube, still = (
            simulation.six_position(
                m, seed, seconds=60 * MINUTES, rate=RATE, misplacement=float(np.radians(tilt)), site=site()
            )
            for m in (model, quiet)
        )
        true = truth(model, "six-position")
        for axis in AXES:  # the bias as it was meanwhile: slow noise is part of it
            pairs = (
                (noisy.imu().axes()[axis][1], still.logs[k].imu().axes()[axis][1]) for k, noisy in cube.logs.items()
            )
            true[axis, "bias"] += float(np.mean([(a - b).mean() for a, b in pairs]))
        for _, axis, parameter, inside in held(calibrate("six-position", cube.logs), true, ""):
            rows.append((condition, axis[:-2], parameter.removesuffix(f"_{parameter[-1]}"), inside))
    return rows


def block(first, last):
    return [(*record(seed), elsewhere(seed)) for seed in range(first, last)]


def study(records=300, workers=2):
    jobs = [(first, min(first + BLOCK, records)) for first in range(0, records, BLOCK)]
    done = [one for part in over_records(block, jobs, workers) for one in part]
    counts = defaultdict(list)
    for rows, *_ in done:
        for method, axis, name, inside in rows:
            counts[method, axis, name].append(inside)
    shares = {key: Share(sum(c), len(c)) for key, c in counts.items()}
    methods = list(dict.fromkeys(key[0] for key in shares))
    tables = (_summary(shares, methods), _left(done), *(_parameters(shares, method) for method in methods))
    return (*tables, _elsewhere(done))


def _elsewhere(done):
    counts = defaultdict(list)
    for *_, rows in done:
        for condition, sensor, kind, inside in rows:
            counts[condition, sensor, kind].append(inside)
    kinds = list(dict.fromkeys(key[1:] for key in counts))
    rows = tuple(
        (condition, *(str(Share(sum(c), len(c))) for c in (counts[condition, *kind] for kind in kinds)))
        for condition in ELSEWHERE
    )
    headings = ("condition", *(f"{sensor} {kind}" for sensor, kind in kinds))
    note = (
        "Pooled over axes. The true bias is the mean over all positions, slow noise included. With a cube that stands perfectly the intervals "
        "are too wide, as six residuals cannot tell that it does. A random walk moves an accelerometer's bias between its own two upright "
        "positions and the others, by more than a position shows within itself: there the interval of its bias is too narrow, and the result "
        "says that noise is slow."
    )
    return Table("Six-position elsewhere", headings, rows, note)


def _summary(shares, methods):
    rows = []
    for method in methods:
        own = {key: s for key, s in shares.items() if key[0] == method}
        pooled = Share(sum(s.count for s in own.values()), sum(s.of for s in own.values()))
        worst = min(own, key=lambda key: own[key].value)
        ok = POOLED[0] <= pooled.value <= POOLED[1] and own[worst].value >= EACH
        rows.append((method, len(own), pooled, f"{own[worst]}, {worst[1]} {worst[2]}", verdict(ok)))
    headings = ("method", "parameters", "inside, pooled", "worst parameter", "93 to 97 % pooled, each at least 90 %")
    return Table("What was wanted", headings, tuple(rows))


def _left(done):
    by_axis = defaultdict(list)
    for _, rest, _ in done:
        for axis, inside, *ratios in rest:
            by_axis[axis].append((inside, *ratios))
    rows = [(axis, *_row(found)) for axis, found in by_axis.items()]
    rows.append(("all", *_row([one for found in by_axis.values() for one in found])))
    note = (
        "The record with z up, less what the six-position and the rate table found together: N from the Allan deviation, against the "
        "model's N over 1 + s, as noise comes behind the scale factor; and the density of its Welch spectrum over 2 N². Means with "
        "their standard errors."
    )
    headings = (
        "axis", "N inside its 95 % interval", "N / true N", f"density / true, to {SPLIT:g} Hz", f"density / true, above {SPLIT:g} Hz",
    )  # fmt: skip
    return Table("Noise of the corrected record", headings, tuple(rows), note)


def _row(found):
    inside, *ratios = (np.array(part, dtype=float) for part in zip(*found, strict=True))
    means = (Mean(float(r.mean()), float(r.std(ddof=1)) / len(r) ** 0.5) for r in ratios)
    return Share(int(inside.sum()), len(inside)), *means


def _parameters(shares, method):
    own = {key[1:]: s for key, s in shares.items() if key[0] == method}
    names = list(dict.fromkeys(name for _, name in own))
    axes = [axis for axis in AXES if any(key[0] == axis for key in own)]
    rows = tuple((name, *(str(own[axis, name]) if (axis, name) in own else "–" for axis in axes)) for name in names)
    return Table(f"Inside the 95 % interval: {method}", ("parameter", *axes), rows)


if __name__ == "__main__":
    main(__file__, QUESTION, study, 300, lambda n: f"seeds 0..{n - 1}; n = {n} sensors")
