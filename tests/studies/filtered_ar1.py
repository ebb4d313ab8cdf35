"""What does a low-pass make of a first-order autoregressive sensor (El-Diasty and Pagiatakis, tables 2 to 5)?

A sensor x(n) + C x(n-1) = e with table 2's C, 1,080,000 samples at 100 Hz, behind Kaiser low-passes of 8, 16 and 24 Hz
(4 Hz from pass to stop band, 100 dB). The first-order coefficient of what comes out follows in closed form from the
sensor's spectrum S and the filter's response H: alpha = -rho(1), rho(1) = ∫ S|H|² cos w / ∫ S|H|². Wanted:
``fit_autoregressive(...).orders[0]`` within 4 of its own (Bartlett's) standard errors of that. Beside them what the paper
printed, read from ``../shared/papers/tables.toml`` where there is such a file.

Table 2 may have the other sign (its text says b(k+1) = C b(k) + e, tables 3 to 5 are all negative); what follows from that is
printed too.

Command: ``python tests/studies/filtered_ar1.py`` (4 records of each sensor: about 2 minutes in one process).
Seeds: record r of sensor number s uses ``SeedSequence([s, r])``.
"""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

import numpy as np
from study_report import Share, Table, main, over_records, verdict

from imuwb.conditioning import design_kaiser, filtered
from imuwb.identification import fit_autoregressive
from imuwb.stochastic import Autoregressive

QUESTION = "The first-order model of a filtered first-order sensor"
RATE, SAMPLES, CUTOFFS, TRANSITION, ATTENUATION = 100.0, 1_080_000, (8.0, 16.0, 24.0), 4.0, 100.0
FREQUENCIES = 1 << 16  #: of the integral, over the whole circle: exact, as it is a trigonometric polynomial but for S
MOST = 4.0  #: standard errors
PAPER = Path(__file__).parents[2] / ".." / "shared" / "papers" / "tables.toml"
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
    """Return the filter of a cutoff in Hz."""
    return design_kaiser(RATE, cutoff - TRANSITION / 2, cutoff + TRANSITION / 2, ATTENUATION).taps


def derived(coefficient, cutoff):
    """Return alpha of the filtered sensor."""
    w = 2 * np.pi * np.arange(FREQUENCIES) / FREQUENCIES
    passed = np.abs(np.fft.fft(taps(cutoff), FREQUENCIES)) ** 2 / np.abs(1 + coefficient * np.exp(-1j * w)) ** 2
    return -float(passed @ np.cos(w) / passed.sum())


def record(number, seed, n):
    """Return alpha and its standard errors, Bartlett's and that of a true first-order series, behind each filter and without."""
    name, place = SENSORS[number]
    sensor = Autoregressive((TABLE2[name][place],), 1.0, 1 / RATE)
    longest = max(taps(cutoff).size for cutoff in CUTOFFS)
    rng = np.random.default_rng(np.random.SeedSequence([number, seed]))
    x = sensor.sample(n + longest - 1, 1 / RATE, rng)
    found = {}
    for cutoff in (None, *CUTOFFS):
        series = (x if cutoff is None else filtered(x, taps(cutoff)))[:n]
        first = fit_autoregressive(series, 1 / RATE).orders[0]
        found[cutoff] = tuple(float(v[0]) for v in (first.alpha, first.alpha_sigma, first.alpha_sigma_if_ar))
    return found


def study(records=4, n=SAMPLES, workers=1, sensors=None):
    """Return the tables: a summary, and one of each filter."""
    sensors = len(SENSORS) if sensors is None else sensors
    jobs = [(s, r, n) for s in range(sensors) for r in range(records)]
    done = over_records(record, jobs, workers)
    found = [[f for (s, _, _), f in zip(jobs, done, strict=True) if s == number] for number in range(sensors)]
    tables = [_table(found, cutoff) for cutoff in (None, *CUTOFFS)]
    return (_summary(found), *tables)


def _true(number, cutoff):
    name, place = SENSORS[number]
    return TABLE2[name][place] if cutoff is None else derived(TABLE2[name][place], cutoff)


def _off(found, number, cutoff):
    """Return how many standard errors each record's coefficient is from the derived one."""
    return np.array([(one[cutoff][0] - _true(number, cutoff)) / one[cutoff][1] for one in found[number]])


def _summary(found):
    rows = []
    for cutoff in (None, *CUTOFFS):
        off = np.concatenate([_off(found, number, cutoff) for number in range(len(found))])
        where = "without a filter" if cutoff is None else f"{cutoff:g} Hz"
        most = float(np.abs(off).max())
        rows.append((f"{where}: largest difference, standard errors", f"at most {MOST:g}", f"{most:.2f}", verdict(most <= MOST)))  # fmt: skip
        rows.append((f"{where}: rms difference, standard errors", "about 1", f"{np.sqrt(np.mean(off**2)):.3f}", "–"))
        inside = Share(int((np.abs(off) <= 1.96).sum()), off.size)
        rows.append((f"{where}: within 1.96 standard errors", "95 %", inside, "–"))
        if cutoff is not None and printed():
            rows.append((f"{where}: paper less derived, rms", "–", _published(len(found), cutoff), "–"))
    return Table("What was wanted", ("figure", "wanted", "reached", "verdict"), tuple(rows))


def _published(sensors, cutoff):
    """Return how far the paper's coefficients are from those derived, for both signs of table 2."""
    apart = [
        np.array([
            printed()[name][f"fc{cutoff:g}"][place] - derived(sign * TABLE2[name][place], cutoff)
            for name, place in SENSORS[:sensors]
        ])
        for sign in (1, -1)
    ]  # fmt: skip
    one, other = (float(np.sqrt(np.mean(a**2))) for a in apart)
    return f"{one:.3f} (other sign of C: {other:.3f})"


@cache
def printed():
    """Return the paper's tables; nothing where they are not there."""
    return tomllib.loads(PAPER.read_text("utf-8"))["eldiasty"]["ar1"] if PAPER.exists() else {}


def _table(found, cutoff):
    rows = []
    for number in range(len(found)):
        name, place = SENSORS[number]
        first, *_ = found[number]
        alpha, sigma, if_ar = first[cutoff]
        off = float(np.abs(_off(found, number, cutoff)).max())
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
    published = ("paper, ± " + f"{printed()['sigma'][f'fc{cutoff:g}']:g}",) if printed() else ()
    number = {8.0: 3, 16.0: 4, 24.0: 5}[cutoff]
    note = (
        "Derived: alpha of the filtered series. Fitted: record 0, ± Bartlett's standard error. The error if the series were "
        "autoregressive, which it is not, is √((1 - alpha²)/n): the paper's ± is of that size."
    )
    return Table(
        f"Low-pass of {cutoff:g} Hz (table {number})",
        (
            *headings, "derived", "fitted", "largest difference, standard errors", "error if autoregressive",
            "derived, other sign of C", *published,
        ),
        tuple(rows), note,
    )  # fmt: skip


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 4,
        lambda n: f"seeds (s, 0..{n - 1}) for sensors s = 0..{len(SENSORS) - 1}; n = {n} records of {SAMPLES} samples each",
    )  # fmt: skip
