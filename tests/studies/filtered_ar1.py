"""Derive and fit the first-order model of a low-pass filtered first-order sensor (El-Diasty and Pagiatakis, tables 2 to 5).

A sensor is x(n) + C x(n-1) = e with C of table 2: 1,080,000 samples at 100 Hz, filtered by Kaiser low-passes of 8, 16 and
24 Hz (4 Hz from pass band to stop band, 100 dB). The first-order coefficient of the filtered series follows in closed form from
the spectrum S of the sensor and the response H of the filter: alpha = -rho(1), rho(1) = ∫ S|H|² cos w / ∫ S|H|². Goal:
``fit_autoregressive(...).orders[0]`` is within 4 of its own (Bartlett's) standard errors of the derived value. The tables
show the paper's figures, too, where the folder of recordings has them (tests/recordings.py).

Table 2 may have the opposite sign: the text of the paper states b(k+1) = C b(k) + e, and tables 3 to 5 are all negative. The
values derived with the opposite sign are printed, too.

Command: ``python tests/studies/filtered_ar1.py`` (4 records of each sensor: about 2 minutes in one process).
Seeds: record r of sensor s uses ``SeedSequence([s, r])``.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from study_report import GOALS, Share, Table, main, over_records, published, verdict

from imuwb.conditioning import design_kaiser, filtered
from imuwb.identification import fit_autoregressive
from imuwb.stochastic import Autoregressive

QUESTION = "The first-order model of a filtered first-order sensor"
RATE, SAMPLES, CUTOFFS, TRANSITION, ATTENUATION = 100.0, 1_080_000, (8.0, 16.0, 24.0), 4.0, 100.0
FREQUENCIES = 1 << 16  #: of the integral over the whole circle; exact for the polynomial of the filter
MOST = 4.0  #: standard errors
#: Table 2, by unit and sensor at -30, 0, 30 and 60 °C; sigma 0.0009.
TABLE2 = {
    "MotionPakII_gyro": (-0.1413, -0.1223, 0.2935, -0.2444),
    "MotionPakII_acc": (-0.2747, -0.1672, -0.0460, -0.0388),
    "AHRS300CC_gyro": (0.1783, 0.13902, -0.0886, 0.1023),
    "AHRS300CC_acc": (0.2515, 0.2805, -0.1188, 0.1655),
}
SENSORS = tuple((name, place) for name in TABLE2 for place in range(4))
CELSIUS = (-30, 0, 30, 60)


@cache
def taps(cutoff):
    """Return the taps of the low-pass with this cut-off (Hz)."""
    return design_kaiser(RATE, cutoff - TRANSITION / 2, cutoff + TRANSITION / 2, ATTENUATION).taps


def derived(coefficient, cutoff):
    """Return alpha of the filtered sensor."""
    w = 2 * np.pi * np.arange(FREQUENCIES) / FREQUENCIES
    passed = np.abs(np.fft.fft(taps(cutoff), FREQUENCIES)) ** 2 / np.abs(1 + coefficient * np.exp(-1j * w)) ** 2
    return -float(passed @ np.cos(w) / passed.sum())


def record(number, seed, n):
    """Return {cut-off: (alpha, Bartlett's standard error, standard error if the series were AR(1))}; None is no filter."""
    name, place = SENSORS[number]
    sensor = Autoregressive((TABLE2[name][place],), 1.0, 1 / RATE)
    longest = max(taps(cutoff).size for cutoff in CUTOFFS)
    rng = np.random.default_rng(np.random.SeedSequence([number, seed]))
    x = sensor.sample(n + longest - 1, 1 / RATE, rng)
    fits = {}
    for cutoff in (None, *CUTOFFS):
        series = (x if cutoff is None else filtered(x, taps(cutoff)))[:n]
        first = fit_autoregressive(series, 1 / RATE).orders[0]
        fits[cutoff] = tuple(float(v[0]) for v in (first.alpha, first.alpha_sigma, first.alpha_sigma_if_ar))
    return fits


def study(records=4, n=SAMPLES, workers=1, sensors=None):
    """Return the tables: a summary, and one table of each filter."""
    sensors = len(SENSORS) if sensors is None else sensors
    jobs = [(s, r, n) for s in range(sensors) for r in range(records)]
    done = over_records(record, jobs, workers)
    fits = [[fit for (s, *_), fit in zip(jobs, done, strict=True) if s == number] for number in range(sensors)]
    return (_summary(fits), *(_table(fits, cutoff) for cutoff in (None, *CUTOFFS)))


def _true(number, cutoff):
    name, place = SENSORS[number]
    return TABLE2[name][place] if cutoff is None else derived(TABLE2[name][place], cutoff)


def _off(fits, number, cutoff):
    """Return the difference of each record's coefficient from the derived coefficient, in standard errors."""
    return np.array([(fit[cutoff][0] - _true(number, cutoff)) / fit[cutoff][1] for fit in fits[number]])


def _summary(fits):
    rows = []
    for cutoff in (None, *CUTOFFS):
        off = np.concatenate([_off(fits, number, cutoff) for number in range(len(fits))])
        where = "without a filter" if cutoff is None else f"{cutoff:g} Hz"
        most = float(np.abs(off).max())
        rows.append((f"{where}: largest difference, standard errors", f"at most {MOST:g}", f"{most:.2f}", verdict(most <= MOST)))  # fmt: skip
        rows.append((f"{where}: rms difference, standard errors", "about 1", f"{np.sqrt(np.mean(off**2)):.3f}", "–"))
        inside = Share(int((np.abs(off) <= 1.96).sum()), off.size)
        rows.append((f"{where}: within 1.96 standard errors", "95 %", inside, "–"))
        if cutoff is not None and printed():
            rows.append((f"{where}: paper minus derived, rms", "–", _difference(len(fits), cutoff), "–"))
    return Table("Goals", GOALS, tuple(rows))


def _difference(sensors, cutoff):
    """Return the rms difference of the paper's coefficients from the derived ones, for both signs of table 2."""
    apart = [
        np.array([
            printed()[name][f"fc{cutoff:g}"][place] - derived(sign * TABLE2[name][place], cutoff)
            for name, place in SENSORS[:sensors]
        ])
        for sign in (1, -1)
    ]  # fmt: skip
    same, opposite = (float(np.sqrt(np.mean(a**2))) for a in apart)
    return f"{same:.3f} (opposite sign of C: {opposite:.3f})"


def printed():
    """Return the paper's coefficients; an empty dict where the file is absent."""
    return published("eldiasty").get("ar1", {})


def _table(fits, cutoff):
    rows = []
    for number in range(len(fits)):
        name, place = SENSORS[number]
        first, *_ = fits[number]
        alpha, sigma, if_ar = first[cutoff]
        off = float(np.abs(_off(fits, number, cutoff)).max())
        row = (name.replace("_", " "), CELSIUS[place], f"{TABLE2[name][place]:.4f}")
        if cutoff is None:
            rows.append((*row, f"{alpha:.4f} ± {sigma:.2g}", off))
            continue
        other = derived(-TABLE2[name][place], cutoff)
        paper = printed().get(name, {}).get(f"fc{cutoff:g}", [])
        row = (*row, f"{_true(number, cutoff):.5f}", f"{alpha:.5f} ± {sigma:.2g}", off, f"{if_ar:.1g}", f"{other:.5f}")
        rows.append((*row, *((f"{paper[place]:.4f}",) if paper else ())))
    headings = ("sensor", "°C", "C of table 2")
    if cutoff is None:
        return Table("Without a filter", (*headings, "fitted", "largest difference, standard errors"), tuple(rows))
    paper_heading = ("paper, ± " + f"{printed()['sigma'][f'fc{cutoff:g}']:g}",) if printed() else ()
    number = {8.0: 3, 16.0: 4, 24.0: 5}[cutoff]
    note = (
        "Derived: alpha of the filtered series. Fitted: alpha of record 0 ± Bartlett's standard error. If the series were "
        "autoregressive, which it is not, the standard error would be √((1 - alpha²)/n); the paper's ± has that size."
    )
    return Table(
        f"Low-pass of {cutoff:g} Hz (table {number})",
        (
            *headings, "derived", "fitted", "largest difference, standard errors", "standard error if autoregressive",
            "derived, opposite sign of C", *paper_heading,
        ),
        tuple(rows), note,
    )  # fmt: skip


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 4,
        lambda n: f"seeds (s, 0..{n - 1}) for sensors s = 0..{len(SENSORS) - 1}; n = {n} records of {SAMPLES} samples each",
    )  # fmt: skip
