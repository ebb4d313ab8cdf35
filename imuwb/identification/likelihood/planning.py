"""How long a still record must be, so that the likelihood states coefficients to a wanted width: from its Fisher information.

The information of the cosine coefficients depends on the processes, the rate and the length alone, not on the samples. Its inverse
is the covariance of the estimated squares (Cramér and Rao), from which the fit itself makes its intervals. So the width of a record
that does not exist yet is known, for the terms that the model has.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.allan_variance.problem import scaled_inverse
from imuwb.identification.coefficient import interval
from imuwb.identification.likelihood.cosine_spectrum import FEWEST, expected_spectrum
from imuwb.identification.likelihood.problem import LikelihoodProblem
from imuwb.statistics.distributions import normal_quantile
from imuwb.stochastic import FlickerNoise, GaussMarkov, Process, Quantization, RandomWalk, Sum, WhiteNoise

LETTERS: Mapping[type, str] = {Quantization: "Q", WhiteNoise: "N", FlickerNoise: "B", RandomWalk: "K"}
UNITS_OF_SIZE: Mapping[str, Callable[[float], Process]] = {
    "Q": Quantization, "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk,
}  # fmt: skip
MOST_HOURS = 1000.0  #: h; no room stays at one temperature for longer
MOST_SAMPLES = 2**40
CLOSE = 1.005  #: ratio of two lengths at which the search ends
SLOWER = 1.05  #: ratio of two lengths at which the slower rate is enough


@dataclass(frozen=True, slots=True)
class Reach:
    """What a record of a length states of one coefficient."""

    value: float | None  #: SI; None: the model has no such term
    width: float  #: half the width of the interval over the value; infinite where the interval begins at 0 or the term is absent
    limit: float  #: SI, upper end of the interval, or the expected upper limit of a term that is absent


def reached(processes: Sum, rate: float, hours: float, level: float = 0.95, letters: str = "QNBK") -> dict[str, Reach]:
    """Return what a still record of one axis is expected to state of some of Q, N, B and K.

    A term that is absent has a likeliest size above 0 in about half of all records, and then widens the others: widths are the
    means over both. A Gauss-Markov process is estimated too, its correlation time being known; other processes are left out.

    Args:
        processes: of the axis, SI.
        rate: Hz.
        hours: length of the record.
        level: of the intervals.
        letters: those that are wanted.

    Raises:
        ValueError: fewer than 256 samples.
    """
    terms = _terms(processes)
    n = min(round(rate * hours * 3600), MOST_SAMPLES)
    if n < FEWEST:
        raise ValueError(f"{n} samples are too few for a likelihood; it needs at least {FEWEST}")
    absent = [letter for letter in UNITS_OF_SIZE if letter not in terms]
    kinds = {name: kind for name, (kind, _) in terms.items()} | {x: UNITS_OF_SIZE[x](1.0) for x in absent}
    squares = np.array([terms[name][1] ** 2 if name in terms else 0.0 for name in kinds])
    information = _problem(tuple(kinds.values()), n, 1 / rate).slope(squares)[1]
    names = list(kinds)
    found: dict[str, Reach] = {}
    for letter in letters:
        sigmas = [
            _sigma(information, names, [*terms, *also, letter], letter)
            for also in _subsets([x for x in absent if x != letter])
        ]
        if letter in terms:
            value = terms[letter][1]
            ends = [interval(value**2, sigma, level) for sigma in sigmas]
            width = float(np.mean([(high - low) / 2 / value if low > 0 else np.inf for low, high in ends]))
            found[letter] = Reach(value, width, float(np.mean([high for _, high in ends])))
        else:
            found[letter] = Reach(None, np.inf, float(np.mean(sigmas) * normal_quantile(level)) ** 0.5)
    return found


def _sigma(information: Floats, names: Sequence[str], free: Sequence[str], letter: str) -> float:
    """Return the standard error of a term's square where some terms are estimated."""
    kept = [i for i, name in enumerate(names) if name in free]
    place = kept.index(names.index(letter))
    return float(scaled_inverse(information[np.ix_(kept, kept)])[place, place]) ** 0.5


def _subsets(letters: Sequence[str]) -> list[tuple[str, ...]]:
    return [found for count in range(len(letters) + 1) for found in combinations(letters, count)]


def hours_needed(
    processes: Sum, letter: str, width: float, rate: float, level: float = 0.95, *, most: float = MOST_HOURS
) -> float | None:
    """Return the shortest length (h) whose record states a coefficient to a width; None: not within ``most`` hours.

    Args:
        processes: of the axis, SI.
        letter: Q, N, B or K.
        width: half the width of the interval over the value, above 0.
        rate: Hz.
        level: of the interval.
        most: h.
    """

    def enough(hours: float) -> bool:
        return reached(processes, rate, hours, level, letter)[letter].width <= width

    if not enough(most):
        return None
    short, long = FEWEST / rate / 3600, most
    while long / short > CLOSE:
        middle = float(np.sqrt(short * long))
        short, long = (short, middle) if enough(middle) else (middle, long)
    return long


def rate_enough(processes: Sum, wants: Mapping[str, float], rate: float, level: float = 0.95) -> float:
    """Return the lowest rate (Hz), of ``rate`` halved again and again, at which the record need be hardly longer.

    The sensor is taken to average over a sample, so that a lower rate folds no noise.
    """
    needed = {letter: hours_needed(processes, letter, width, rate, level) for letter, width in wants.items()}
    hours = {letter: length for letter, length in needed.items() if length is not None}
    allowed = SLOWER * max(hours.values(), default=0.0)

    def enough(slower: float) -> bool:
        if allowed * slower * 3600 < FEWEST:
            return False
        found = reached(processes, slower, allowed, level, "".join(hours))
        return all(found[letter].width <= wants[letter] for letter in hours)

    while hours and enough(rate / 2):
        rate /= 2
    return rate


def _terms(processes: Sum) -> dict[str, tuple[Process, float]]:
    """Return the processes that are estimated, each of size 1, with their sizes; those of one kind are one."""
    found: dict[str, tuple[Process, float]] = {}
    for term in processes.terms:
        letter = LETTERS.get(type(term))
        if letter is not None:
            size = float(np.hypot(getattr(term, letter), found.get(letter, (term, 0.0))[1]))
            if size > 0:
                found[letter] = UNITS_OF_SIZE[letter](1.0), size
        elif isinstance(term, GaussMarkov) and term.sigma > 0:
            found[f"GM {term.Tc}"] = replace(term, sigma=1.0), term.sigma
    return found


@lru_cache(64)
def _problem(kinds: Sequence[Process], n: int, dt: float) -> LikelihoodProblem:
    return LikelihoodProblem.of(expected_spectrum(n, dt), kinds)
