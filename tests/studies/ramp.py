"""Compare N(T) on a ramp of 10 h from -40 to 70 °C with its bound, and test the coverage of B, K and hysteresis.

A gyro at 100 Hz has an N that grows by 20 % over the ramp (0.3 deg/√h at 15 °C), flicker (7.2 deg/h) and a random walk
(15.8 deg/h^1.5) that do not depend on temperature, and a thermal bias of 1 deg/s over the ramp with a parabola of 0.3 deg/s. The
thermometer has 1 Hz and a noise of 0.1 °C. ``stretches`` cuts the ramp into 22 bins of 5 °C; ``set_point_of`` removes the drift of each
bin. The Cramer-Rao bound of N from the n samples of a bin is N/√(2n) if all else is known; with B and K unknown, the bound comes
from the information matrix of the likelihood at the truth. Goals: the rms error of N over all bins is at most 1.2 times the first
bound; B and K are inside their 95 % intervals, or below their limits, in at least 93 % of bins.

In the second half of the records, the ramp goes up and down. The hysteresis is the bias of the rising ramp minus that of the falling
ramp; it is 0, apart from the sensor's random walk. Goal: 0 is inside its interval in at least 93 % of cases.

Command: ``python tests/studies/ramp.py`` (20 records: about 4 minutes in one process).
Seeds: ``numpy.random.default_rng(r)`` draws record r.
"""

from __future__ import annotations

import numpy as np
from study_report import GOALS, Share, Table, main, over_records, verdict

from imuwb.identification.temperature import Record, over_temperature, set_point_of, smooth_temperature, stretches
from imuwb.stochastic import FlickerNoise, RandomWalk, Sum

QUESTION = "N, B and K along a ramp of ten hours"
RATE, HOURS, DEGREE = 100.0, 10.0, np.pi / 180
TRUTH = {"N": 0.005 * DEGREE, "B": 0.002 * DEGREE, "K": 7.3e-5 * DEGREE}
CHANGE, SWING, BEND, THERMOMETER = 0.2, DEGREE, 0.3 * DEGREE, 0.1
MOST, COVERED, FEWEST = 1.2, 0.93, 5000


def white(celsius):
    """Return N at a temperature (°C), rad/√s."""
    return TRUTH["N"] * (1 + CHANGE * (celsius - 15) / 110)


def bias(celsius):
    """Return the thermal bias at a temperature (°C), rad/s."""
    return SWING * (celsius - 15) / 110 + BEND * ((celsius - 15) / 55) ** 2


def sampled(seed, hours, *, back):
    """Return times, samples, and the thermometer's times and readings, of one ramp."""
    rng = np.random.default_rng(seed)
    n = round(hours * 3600 * RATE)
    t, along = np.arange(n) / RATE, np.linspace(0, 1, n)
    celsius = -40 + 110 * (1 - np.abs(2 * along - 1) if back else along)
    x = white(celsius) * rng.standard_normal(n) * RATE**0.5 + bias(celsius)
    x += Sum((FlickerNoise(TRUTH["B"]), RandomWalk(TRUTH["K"]))).sample(n, 1 / RATE, rng)
    time = np.arange(0, t[-1], 1.0)
    return t, x, time, np.interp(time, t, celsius) + THERMOMETER * rng.standard_normal(time.size)


def record(seed, hours, back):
    """Return the estimates of each bin, the function N(T), and the intervals of the hysteresis."""
    t, x, time, read = sampled(seed, hours, back=back)
    kind, parts = stretches(time, read, RATE)
    assert kind == "bins"
    groups = {}
    for s in parts:
        inside = slice(*np.searchsorted(t, [s.start, s.end]))
        if inside.stop - inside.start < FEWEST:  # a short bin at the turning point
            continue
        warm = smooth_temperature(time, read, t[inside])
        groups.setdefault(s.nominal, []).append(Record(x[inside], t[inside.start], float(warm.mean()), warm, s.rising))
    over = over_temperature([set_point_of(group, 1 / RATE) for _, group in sorted(groups.items())])
    bins = [
        (
            p.celsius,
            p.samples,
            {k: _row(p.coefficients[k]) for k in TRUTH},
            _bound(p),
            (b.estimate.value - bias(b.temperature), b.estimate.sigma),
        )
        for p, b in zip(over.points, over.biases.at, strict=True)
    ]
    return bins, over.laws["N"].function, [(h.difference.lower, h.difference.upper) for h in over.biases.hysteresis]


def _row(c):
    return c.value, c.lower, c.upper


def _bound(point):
    """Return the Cramer-Rao bound of N, relative to N, with B and K unknown."""
    squared = np.array([0.0, white(point.celsius) ** 2, TRUTH["B"] ** 2, TRUTH["K"] ** 2])
    information = point.problem.slope(squared)[1][1:, 1:]
    size = np.sqrt(information.diagonal())
    inverse = np.linalg.inv(information / np.outer(size, size)) / np.outer(size, size)
    return inverse[0, 0] ** 0.5 / (2 * squared[1])


def study(records=20, hours=HOURS, workers=1):
    """Return the tables: a summary, and the bins."""
    jobs = [(seed, hours, 2 * seed >= records) for seed in range(records)]
    done = over_records(record, jobs, workers)
    up = [result for result, (*_, back) in zip(done, jobs, strict=True) if not back]
    return _summary(up, done), _bins(up)


def errors(done):
    """Return N's relative error, its bound if all else is known, and its bound with B and K unknown, of all bins."""
    cells = [(c["N"][0] / white(t) - 1, (2 * n) ** -0.5, b) for bins, *_ in done for t, n, c, b, _ in bins]
    return (np.array(column) for column in zip(*cells, strict=True))


def coverage(done, letter):
    """Return the share of intervals, or limits, that contain the truth."""
    cells = [(c[letter], white(t) if letter == "N" else TRUTH[letter]) for bins, *_ in done for t, _, c, *_ in bins]
    return Share(sum((lower or 0.0) <= true <= upper for (_, lower, upper), true in cells), len(cells))


def _summary(up, done):
    error, alone, beside = errors(done)
    ratio = float(np.sqrt(np.mean((error / alone) ** 2)))
    rows = [
        (
            "rms error of N over its bound, all else known",
            f"at most {MOST:g}",
            f"{ratio:.3f}",
            verdict(ratio <= MOST),
        ),
        ("rms error of N over its bound, B and K unknown", "–", f"{np.sqrt(np.mean((error / beside) ** 2)):.3f}", "–"),
        ("mean error of N, %", "–", f"{100 * error.mean():.4f} ± {100 * error.std() / error.size**0.5:.4f}", "–"),
    ]
    for letter in TRUTH:
        share = coverage(done, letter)
        rows.append((f"coverage of {letter}", f"at least {100 * COVERED:g} %", share, verdict(share.value >= COVERED)))
    off = np.concatenate([_off([pair for *_, pair in bins]) for bins, *_ in up])
    rows.append(
        (
            "error of the bias, minus its mean, within 1.96 standard errors",
            "–",
            Share(int((np.abs(off) <= 1.96).sum()), off.size),
            "–",
        )
    )
    loops = [low <= 0 <= high for *_, intervals in done for low, high in intervals]
    share = Share(sum(loops), len(loops))
    rows.append(
        ("hysteresis: 0 inside its interval", f"at least {100 * COVERED:g} %", share, verdict(share.value >= COVERED))
    )
    celsius = np.linspace(-35, 65, 21)
    ends = [law.at(celsius) for _, law, _ in done]
    curve = np.concatenate([value / white(celsius) - 1 for value, _, _ in ends])
    rows.append(("rms error of the function N(T), %", "–", f"{100 * np.sqrt(np.mean(curve**2)):.3f}", "–"))
    inside = np.concatenate([(lower <= white(celsius)) & (white(celsius) <= upper) for _, lower, upper in ends])
    rows.append(("coverage of N(T) by the function's interval", "–", Share(int(inside.sum()), inside.size), "–"))
    kinds = [law.kind for _, law, _ in done]
    counts = ", ".join(f"{kind} {kinds.count(kind)}" for kind in dict.fromkeys(kinds))
    rows.append(("kinds of the functions N(T)", "–", counts, "–"))
    return Table("Goals", GOALS, tuple(rows))


def _off(pairs):
    """Return the error of each bin's bias, minus the mean error of all bins, in standard errors."""
    error, sigma = (np.array(column) for column in zip(*pairs, strict=True))
    return (error - error.mean()) / sigma


def _bins(up):
    rows = []
    for place in range(min(len(bins) for bins, *_ in up)):
        here = [bins[place] for bins, *_ in up]
        t, n = here[0][0], here[0][1]
        error = np.array([c["N"][0] / white(at) - 1 for at, _, c, *_ in here])
        row = [f"{t:.1f}", n, f"{100 * np.sqrt(np.mean(error**2)):.3f}", f"{100 / (2 * n) ** 0.5:.3f}"]
        for letter in ("B", "K"):
            estimates = [c[letter] for *_, c, _, _ in here]
            row.append(Share(sum(bool(v and low) for v, low, _ in estimates), len(estimates)))
            row.append(Share(sum((low or 0.0) <= TRUTH[letter] <= high for _, low, high in estimates), len(estimates)))
        rows.append(tuple(row))
    headings = (
        "°C", "samples", "rms error of N, %", "bound, all else known, %", "B identified", "coverage of B", "K identified",
        "coverage of K",
    )  # fmt: skip
    return Table("Bins of the ramps that only go up", headings, tuple(rows))


if __name__ == "__main__":
    main(__file__, QUESTION, study, 20, lambda n: f"seeds 0..{n - 1}; ramps from seed {n // 2} on go up and down")
