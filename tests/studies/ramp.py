"""A ramp of 10 h from -40 to 70 °C: how near is N(T) to its bound, and are B and K held, while the bias follows the temperature?

A gyro whose N grows by 20 % over the ramp (0.3 deg/√h at 15 °C), with flicker (7.2 deg/h) and a random walk (15.8 deg/h^1.5) that do not, at
100 Hz, and a thermal bias of 1 deg/s over the ramp with a parabola of 0.3 deg/s; a thermometer of 1 Hz that is noisy by 0.1 °C.
Cut into 22 bins of 5 °C by ``stretches``; ``identify`` takes the drift out of each. The bound is Cramer and Rao's for N from the
n samples of a bin: 1/√(2n) of N if it is all that is unknown, and with B and K unknown that of the likelihood's own information
at the truth. Wanted: the rms error of N over all bins at most 1.2 times the first; B and K inside their 95 % intervals, or below their
limits, in at least 93 %.

The second half of the records goes up and down again: rising less falling, which is 0 but for the sensor's own walk, inside its interval
in at least 93 %.

Command: ``python tests/studies/ramp.py`` (20 records: about 4 minutes in one process).
Seeds: record r is drawn by ``default_rng(r)``.
"""

from __future__ import annotations

import numpy as np
from study_report import Share, Table, main, over_records, verdict

from imuwb.identification.temperature import Record, identify, over_temperature, smooth_temperature, stretches
from imuwb.stochastic import FlickerNoise, RandomWalk, Sum

QUESTION = "N, B and K along a ramp of ten hours"
RATE, HOURS, DEGREE = 100.0, 10.0, np.pi / 180
TRUTH = {"N": 0.005 * DEGREE, "B": 0.002 * DEGREE, "K": 7.3e-5 * DEGREE}
CHANGE, SWING, BEND, THERMOMETER = 0.2, DEGREE, 0.3 * DEGREE, 0.1
MOST, HELD, FEWEST = 1.2, 0.93, 5000


def white(celsius):
    """Return N at a temperature."""
    return TRUTH["N"] * (1 + CHANGE * (celsius - 15) / 110)


def bias(celsius):
    """Return the thermal bias, rad/s."""
    return SWING * (celsius - 15) / 110 + BEND * ((celsius - 15) / 55) ** 2


def sampled(seed, hours, *, back):
    """Return time, samples, the thermometer's times and readings of one ramp."""
    rng = np.random.default_rng(seed)
    n = round(hours * 3600 * RATE)
    t, along = np.arange(n) / RATE, np.linspace(0, 1, n)
    celsius = -40 + 110 * (1 - np.abs(2 * along - 1) if back else along)
    x = white(celsius) * rng.standard_normal(n) * RATE**0.5 + bias(celsius)
    x += Sum((FlickerNoise(TRUTH["B"]), RandomWalk(TRUTH["K"]))).sample(n, 1 / RATE, rng)
    time = np.arange(0, t[-1], 1.0)
    return t, x, time, np.interp(time, t, celsius) + THERMOMETER * rng.standard_normal(time.size)


def record(seed, hours, back):
    """Return what was found in each bin, the slopes of the functions, and the loops."""
    t, x, time, read = sampled(seed, hours, back=back)
    cut, found = stretches(time, read, RATE)
    assert cut == "bins"
    groups = {}
    for s in found:
        inside = slice(*np.searchsorted(t, [s.start, s.end]))
        if inside.stop - inside.start < FEWEST:  # a sliver where it turns
            continue
        warm = smooth_temperature(time, read, t[inside])
        groups.setdefault(s.nominal, []).append(Record(x[inside], t[inside.start], float(warm.mean()), warm, s.rising))
    over = over_temperature([identify(group, 1 / RATE) for _, group in sorted(groups.items())])
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
    """Return Cramer and Rao's bound of N, relative, with B and K unknown."""
    squared = np.array([0.0, white(point.celsius) ** 2, TRUTH["B"] ** 2, TRUTH["K"] ** 2])
    information = point.problem.slope(squared)[1][1:, 1:]
    size = np.sqrt(information.diagonal())
    inverse = np.linalg.inv(information / np.outer(size, size)) / np.outer(size, size)
    return inverse[0, 0] ** 0.5 / (2 * squared[1])


def study(records=20, hours=HOURS, workers=1):
    """Return the tables: a summary, and the bins."""
    jobs = [(seed, hours, 2 * seed >= records) for seed in range(records)]
    done = over_records(record, jobs, workers)
    up = [one for one, (*_, back) in zip(done, jobs, strict=True) if not back]
    return _summary(up, done), _bins(up)


def errors(done):
    """Return N's relative error, its bound alone, and its bound beside B and K, of all bins."""
    cells = [(c["N"][0] / white(t) - 1, (2 * n) ** -0.5, b) for bins, *_ in done for t, n, c, b, _ in bins]
    return (np.array(column) for column in zip(*cells, strict=True))


def held(done, letter):
    """Return how often an interval, or a limit, holds the truth."""
    cells = [(c[letter], white(t) if letter == "N" else TRUTH[letter]) for bins, *_ in done for t, _, c, *_ in bins]
    return Share(sum((lower or 0.0) <= true <= upper for (_, lower, upper), true in cells), len(cells))


def _summary(up, done):
    error, alone, beside = errors(done)
    ratio = float(np.sqrt(np.mean((error / alone) ** 2)))
    rows = [
        (
            "rms error of N over its bound, nothing else unknown",
            f"at most {MOST:g}",
            f"{ratio:.3f}",
            verdict(ratio <= MOST),
        ),
        ("rms error of N over its bound, B and K unknown", "–", f"{np.sqrt(np.mean((error / beside) ** 2)):.3f}", "–"),
        ("mean error of N, %", "–", f"{100 * error.mean():.4f} ± {100 * error.std() / error.size**0.5:.4f}", "–"),
    ]
    for letter in TRUTH:
        share = held(done, letter)
        rows.append((f"{letter} held", f"at least {100 * HELD:g} %", share, verdict(share.value >= HELD)))
    off = np.concatenate([_off([pair for *_, pair in bins]) for bins, *_ in up])
    rows.append(
        (
            "bias, less its mean, within 1.96 standard errors",
            "–",
            Share(int((np.abs(off) <= 1.96).sum()), off.size),
            "–",
        )
    )
    loops = [low <= 0 <= high for *_, found in done for low, high in found]
    share = Share(sum(loops), len(loops))
    rows.append(
        ("no hysteresis: 0 inside its interval", f"at least {100 * HELD:g} %", share, verdict(share.value >= HELD))
    )
    celsius = np.linspace(-35, 65, 21)
    ends = [law.at(celsius) for _, law, _ in done]
    curve = np.concatenate([value / white(celsius) - 1 for value, _, _ in ends])
    rows.append(("rms error of the function N(T), %", "–", f"{100 * np.sqrt(np.mean(curve**2)):.3f}", "–"))
    inside = np.concatenate([(lower <= white(celsius)) & (white(celsius) <= upper) for _, lower, upper in ends])
    rows.append(("N(T) inside the function's interval", "–", Share(int(inside.sum()), inside.size), "–"))
    kinds = [law.kind for _, law, _ in done]
    rows.append(("functions chosen", "–", ", ".join(f"{k} {kinds.count(k)}" for k in dict.fromkeys(kinds)), "–"))
    return Table("What was wanted", ("figure", "wanted", "reached", "verdict"), tuple(rows))


def _off(pairs):
    """Return each bin's bias less the mean of all, in standard errors."""
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
            known = [c[letter] for *_, c, _, _ in here]
            row.append(Share(sum(bool(v and low) for v, low, _ in known), len(known)))
            row.append(Share(sum((low or 0.0) <= TRUTH[letter] <= high for _, low, high in known), len(known)))
        rows.append(tuple(row))
    headings = ("°C", "samples", "rms error of N, %", "bound, %", "B identified", "B held", "K identified", "K held")
    return Table("Bins of the ramps that go up", headings, tuple(rows))


if __name__ == "__main__":
    main(__file__, QUESTION, study, 20, lambda n: f"seeds 0..{n - 1}, of which those from {n // 2} on go up and down")
