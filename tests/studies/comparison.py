"""Compare the tools of the field on the same simulated records: errors against the truth, coverage, CPU time, memory.

Two sensors are simulated: one with white noise, flicker and a random walk (N, B, K), and one with white noise alone, which has
nothing to find but N. Every tool gets the same samples and the sampling rate, and is set as its own pages recommend:

* imuwb: ``fit_likelihood``, the headline estimator of ``imuwb noise``, and ``fit_allan``, both with their defaults;
* allan-variance: ``compute_avar`` with its defaults, and ``estimate_parameters`` for the effects white, flicker and walk;
* allantools: ``oadev`` at its "decade" times, with intervals of ``edf_greenhall`` and ``confidence_interval``. It states no N, B and
  K, so they are read as IEEE 952 reads them: N at 1 s, B at the minimum over 0.664, K on a line of slope 1/2 through the last time up to
  a tenth of the record, if that time is beyond the minimum;
* MATLAB's published procedure ("Inertial Sensor Noise Analysis Using Allan Variance"): 100 times spaced evenly in the logarithm, and the
  line of slope -1/2, 0 or 1/2 through the point whose local slope is nearest to it, read at 1 s, over 0.664, and at 3 s;
* NaveGo's published procedure: nine times a decade, N at 1 s, B at the minimum. NaveGo calls the minimum itself the bias instability; here it
  is divided by 0.664, as all others are. NaveGo states no K;
* statsmodels: Burg's model of order 20; N is the standard deviation of its innovations times the root of the sampling time. It states no B and K;
* astropy: ``LombScargle``, method "fast", normalization "psd"; it states no N, B and K, so the sum of their densities is fitted to its means
  in 64 bins (``scipy.optimize.nnls``, each mean weighted by its own standard error under the fit, 10 rounds).

The two procedures are written here from their descriptions; their curves are those of ``allantools.oadev``, which are the overlapping
Allan deviation that both describe. The Cramér-Rao bound is that of a tool that knows which terms there are: the inverse of
imuwb's Fisher information, from which ``imuwb plan`` takes its widths. CPU time and memory are those of one long record, in a process of
the tool's own that has run it once on a short one; memory is the growth of that process, above the samples.

Command: ``python tests/studies/comparison.py`` (100 records of each sensor: about 2 minutes of one processor). It needs
``pip install -e ".[bench,test]" statsmodels allan-variance``.
Seeds: record r of a sensor uses ``SeedSequence(r)``.
"""

from __future__ import annotations

import math
import multiprocessing
import platform
import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np
from scipy import optimize
from study_report import Share, Table, main, over_records

from imuwb.identification import allan, fit_allan, fit_likelihood
from imuwb.identification.allan_variance.problem import scaled_inverse
from imuwb.identification.likelihood.cosine_spectrum import expected_spectrum
from imuwb.identification.likelihood.problem import LikelihoodProblem
from imuwb.stochastic import FlickerNoise, RandomWalk, Sum, WhiteNoise
from tests.benchmarks.measure import cpu, resident

QUESTION = "The tools of the field on the same records"
RATE, SAMPLES, LONG, LEVEL = (
    10.0,
    2**16,
    2**21,
    0.95,
)  #: LONG: samples of the record on which time and memory are measured
DEGREE = np.pi / 180
KINDS = {"N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk}
UNITS = {"N": (DEGREE / 60, "deg/√h"), "B": (DEGREE / 3600, "deg/h"), "K": (DEGREE / 60**3, "deg/h^1.5")}
TRUTH = {"N": 0.3 * UNITS["N"][0], "B": 9.0 * UNITS["B"][0], "K": 108.0 * UNITS["K"][0]}
SENSORS = {"N, B and K": "NBK", "N alone": "N"}
FLAT = math.sqrt(2 * math.log(2) / math.pi)  #: Allan deviation of flicker over B, 0.664
ROUNDS = 10
NONE = (None, None, None)  #: no value, no lower and no upper end


def of_imuwb(x):
    return _coefficients(fit_likelihood(x, 1 / RATE, level=LEVEL))


def of_imuwb_allan(x):
    return _coefficients(fit_allan(allan(x, 1 / RATE)))


def of_allan_variance(x):
    from allan_variance import compute_avar, estimate_parameters

    tau, variance = compute_avar(x, 1 / RATE)
    found = estimate_parameters(tau, variance, effects=["white", "flicker", "walk"])[0]
    return {letter: (float(found[name]) or None, None, None) for letter, name in zip("NBK", found.index, strict=True)}


def of_allantools(x):
    import allantools

    tau, deviation, _, _ = allantools.oadev(x, rate=RATE, data_type="freq", taus="decade")

    def read(place, alpha, factor):
        freedom = allantools.edf_greenhall(alpha, 2, round(tau[place] * RATE), x.size, overlapping=True, modified=False)
        low, high = allantools.confidence_interval(deviation[place], freedom, LEVEL)
        return tuple(float(value * factor) for value in (deviation[place], low, high))

    lowest = int(np.argmin(deviation))
    last = int(np.searchsorted(tau, x.size / RATE / 10 * (1 + 1e-9))) - 1
    return {
        "N": read(int(np.argmin(np.abs(tau - 1))), 0, 1.0),
        "B": read(lowest, -1, 1 / FLAT),
        "K": read(last, -2, math.sqrt(3 / tau[last])) if last > lowest else NONE,
    }


def of_matlab(x):
    import allantools

    longest = 2 ** math.floor(math.log2(x.size / 2))
    samples = np.unique(np.ceil(np.logspace(0, math.log10(longest), 100)))
    tau, deviation, _, _ = allantools.oadev(x, rate=RATE, data_type="freq", taus=samples / RATE)
    slopes = np.diff(np.log10(deviation)) / np.diff(np.log10(tau))

    def read(slope, at):
        place = int(np.argmin(np.abs(slopes - slope)))
        return float(deviation[place] * (at / tau[place]) ** slope)

    return {
        "N": (read(-0.5, 1.0), None, None),
        "B": (read(0.0, 1.0) / FLAT, None, None),
        "K": (read(0.5, 3.0), None, None),
    }


def of_navego(x):
    import allantools

    decades = range(math.floor(math.log10(1 / RATE)), math.floor(math.log10(x.size / RATE / 2)))
    times = np.unique([digit * 10.0**decade for decade in decades for digit in range(1, 11)])
    tau, deviation, _, _ = allantools.oadev(x, rate=RATE, data_type="freq", taus=times)
    return {
        "N": (float(np.interp(1.0, tau, deviation)), None, None),
        "B": (float(deviation.min()) / FLAT, None, None),
        "K": NONE,
    }


def of_statsmodels(x):
    from statsmodels.regression.linear_model import burg

    return {"N": (math.sqrt(burg(x, order=20)[1] / RATE), None, None), "B": NONE, "K": NONE}


def of_astropy(x):
    from astropy.timeseries import LombScargle

    frequency = np.arange(1, x.size // 2) * RATE / x.size
    power = LombScargle(np.arange(x.size) / RATE, x, normalization="psd").power(
        frequency, method="fast", assume_regular_frequency=True
    )
    edges = np.unique(np.round(np.geomspace(1, frequency.size, 65)).astype(int)) - 1
    count = np.diff(edges)
    density = np.add.reduceat(power[: edges[-1]], edges[:-1]) / count / RATE
    centre = np.sqrt(frequency[edges[:-1]] * frequency[edges[1:] - 1])
    design = np.stack([np.ones_like(centre), 1 / (2 * np.pi * centre), 1 / (2 * np.pi * centre) ** 2], axis=1)
    squares, model = np.zeros(3), density
    for _ in range(ROUNDS):
        weight = np.sqrt(count) / model
        squares = optimize.nnls(design * weight[:, None], density * weight)[0]
        model = design @ squares
    return {letter: (math.sqrt(square) or None, None, None) for letter, square in zip("NBK", squares, strict=True)}


#: tool -> its estimator, and the packages whose versions are stated
TOOLS = {
    "imuwb, likelihood": (of_imuwb, ("imuwb",)),
    "imuwb, Allan": (of_imuwb_allan, ("imuwb",)),
    "allan-variance": (of_allan_variance, ("allan-variance",)),
    "allantools, read as IEEE 952": (of_allantools, ("AllanTools",)),
    "MATLAB's procedure": (of_matlab, ("AllanTools",)),
    "NaveGo's procedure": (of_navego, ("AllanTools",)),
    "statsmodels, Burg": (of_statsmodels, ("statsmodels",)),
    "astropy, LombScargle": (of_astropy, ("astropy",)),
}


def _coefficients(fit):
    return {letter: (c.value, c.lower, c.upper) for letter, c in fit.coefficients.items() if letter in KINDS}


def simulated(letters, seed, samples):
    """Return the samples of a sensor that has some of N, B and K, rad/s."""
    terms = Sum(tuple(KINDS[letter](TRUTH[letter]) for letter in letters))
    return terms.sample(samples, 1 / RATE, np.random.default_rng(np.random.SeedSequence(seed)))


def record(letters, seed, samples):
    """Return {tool: {letter: (value, lower, upper)}} of one record; None where a tool states none."""
    x = simulated(letters, seed, samples)
    return {name: estimate(x) for name, (estimate, _) in TOOLS.items()}


def bounds(letters, samples):
    """Return {letter: smallest standard error of an unbiased estimate, over the value} (Cramér and Rao)."""
    problem = LikelihoodProblem.of(expected_spectrum(samples, 1 / RATE), [KINDS[letter](1.0) for letter in letters])
    squares = np.array([TRUTH[letter] ** 2 for letter in letters])
    covariance = scaled_inverse(problem.slope(squares)[1])
    return dict(zip(letters, np.sqrt(np.diag(covariance)) / (2 * squares), strict=True))


def costs_of(samples):
    """Return {tool: (CPU time in s, growth of memory in MB)} on one record, each in a process of its own.

    A process inherits its parent's largest memory, so this one must still be small, and another one simulates.
    """
    with (
        tempfile.TemporaryDirectory() as folder,
        multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool,
    ):
        path = Path(folder) / "samples.npy"
        pool.apply(_save, (path, samples))
        return {name: pool.apply(_measured, (name, path)) for name in TOOLS}


def _save(path, samples):
    np.save(path, simulated("NBK", 0, samples))


def _measured(name, path):
    x, estimate = np.load(path), TOOLS[name][0]
    estimate(x[: 2**12])
    before = resident()
    return cpu(lambda: estimate(x), runs=1), (resident() - before) / 1e6


def study(records=100, samples=SAMPLES, workers=1, long=LONG):
    """Return the tables: errors where there are N, B and K, what is found where there is N alone, and the costs."""
    costs = costs_of(long)
    fits = {
        sensor: over_records(record, [(letters, seed, samples) for seed in range(records)], workers)
        for sensor, letters in SENSORS.items()
    }
    full, white = fits.values()
    return (_errors(full, samples), _false_terms(white, samples), _costs(costs, long))


def _errors(fits, samples):
    least, rows = bounds("NBK", samples), []
    for letter, true in TRUTH.items():
        rows.append((letter, "*Cramér-Rao bound*", "0", f"{100 * least[letter]:.3g}", "", "", "", ""))
        for name in TOOLS:
            own = [fit[name][letter] for fit in fits]
            if all(value is None for value, _, _ in own):
                rows.append((letter, name, "states none", "", "", "", "", ""))
                continue
            errors = np.array([(value or 0.0) / true - 1 for value, _, _ in own])
            rms = float(np.sqrt(np.mean(errors**2)))
            inside = [(low or 0.0) <= true <= high for _, low, high in own if high is not None]
            rows.append((
                letter, name, f"{100 * errors.mean():+.2g}", f"{100 * rms:.3g}", f"{rms / least[letter]:.2g}",
                f"{100 * float(np.median(np.abs(errors))):.3g}",
                f"{100 * np.mean([value is None for value, _, _ in own]):.0f} %",
                Share(sum(inside), len(inside)).text(0) if inside else "no interval",
            ))  # fmt: skip
    truth = ", ".join(f"{letter} {true / UNITS[letter][0]:.3g} {UNITS[letter][1]}" for letter, true in TRUTH.items())
    note = (
        f"Truth: {truth}. Errors are relative to it. A term that a tool does not state in a record counts as an estimate of 0. "
        "An unbiased tool cannot have an rms error below the bound; a biased one can, and an rms error of so many records scatters "
        f"by {100 / math.sqrt(2 * len(fits)):.0f} % itself."
    )
    headings = (
        "term",
        "tool",
        "bias, %",
        "rms error, %",
        "over the bound",
        "median error, %",
        "not stated",
        "95 % intervals with the truth",
    )
    return Table("A sensor with N, B and K", headings, tuple(rows), note)


def _false_terms(fits, samples):
    least, rows = bounds("N", samples)["N"], []
    for name in TOOLS:
        errors = np.array([fit[name]["N"][0] / TRUTH["N"] - 1 for fit in fits])
        cells = [f"{100 * errors.mean():+.2g}", f"{100 * float(np.sqrt(np.mean(errors**2))):.3g}"]
        for letter in "BK":
            own = [fit[name][letter] for fit in fits]
            stated = np.array([value for value, low, high in own if _stated(value, low, high)]) / UNITS[letter][0]
            cells.append(f"{100 * stated.size / len(own):.0f} %")
            cells.append(f"{np.median(stated):.2g}" if stated.size else "")
        rows.append((name, *cells))
    note = (
        f"Truth: N {TRUTH['N'] / UNITS['N'][0]:.3g} {UNITS['N'][1]}, and neither B nor K. The bound of N is {100 * least:.3g} %. A tool "
        "that states B or K here gives a filter a bias that the sensor does not have. A value whose interval begins at 0 does not count: it is an upper "
        "limit. Medians are over the records in which the tool states the term."
    )
    headings = (
        "tool",
        "bias of N, %",
        "rms error of N, %",
        "states B",
        f"its median, {UNITS['B'][1]}",
        "states K",
        f"its median, {UNITS['K'][1]}",
    )
    return Table("A sensor with N alone", headings, tuple(rows), note)


def _stated(value, low, high):
    """Return whether a tool states a term: it gives a value, and no interval that begins at 0."""
    return value is not None and (high is None or (low or 0.0) > 0)


def _costs(costs, long):
    rows = tuple(
        (
            name,
            f"{seconds:.2g}",
            f"{megabytes:.0f}",
            ", ".join(f"{package} {version(package)}" for package in TOOLS[name][1]),
        )
        for name, (seconds, megabytes) in costs.items()
    )
    note = (
        f"One record of {long} samples. Times differ by 20 % from run to run. Python {platform.python_version()}, "
        f"numpy {version('numpy')}, scipy {version('scipy')}."
    )
    return Table("Time and memory", ("tool", "CPU, s", "memory above the samples, MB", "version"), rows, note)


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 100,
        lambda n: f"seeds 0..{n - 1}, n = {n} records of each sensor, {SAMPLES} samples at {RATE:g} Hz",
    )  # fmt: skip
