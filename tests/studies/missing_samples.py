"""Test the bias and the degrees of freedom of Allan variances of records with missing samples.

A record is 60,000 samples at 100 Hz of white noise, flicker and a random walk; each of the three dominates about a third of
the averaging times. The record is used whole, with 5 and 20 % of the samples removed at random, and with three gaps of a minute
each at random places. Each goes through ``allan(values, dt, breaks=..., time=...)`` at octaves; records with the same seed have
the same noise. Goal: the bias is 0 within chance at every octave.

Where gaps leave less than half of the second differences, an averaging time is bridged: means of the remaining samples stand for
whole means. Bridging reduces the degrees of freedom, because the means contain additional noise. The tables estimate the right
reduction in two ways: from the ratio of the measured scatter to the scatter that the given degrees of freedom predict, and from
the scatter of the whole records, which needs no noise type. White noise alone, and quantization with white noise, follow with
half as many records: for them, missing samples add most noise.

Command: ``python tests/studies/missing_samples.py`` (400 records: about 6 minutes in one process).
Seeds: record r uses ``SeedSequence(r).spawn(2)``, for the noise and for what is missing.
"""

from __future__ import annotations

import numpy as np
from study_report import GOALS, Mean, Share, Table, main, over_records, verdict

from imuwb.identification import allan
from imuwb.identification.allan_variance.overlapping import BRIDGE
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, Sum, WhiteNoise

QUESTION = "Allan variances of records with samples missing"
RATE, SAMPLES = 100.0, 60_000
NOISES = {
    "N + B + K": WhiteNoise(1.0) + FlickerNoise(1.5) + RandomWalk(0.55),
    "N": Sum((WhiteNoise(1.0),)),
    "Q + N": Quantization(0.3) + WhiteNoise(1.0),
}
GAPS, GAP = 3, 6000  #: samples
KINDS = ("whole", "5 % missing", "20 % missing", "three long gaps")
FEW = 5.0  #: degrees of freedom; with fewer, the distribution of a variance is too skew for its scatter to be compared


def kept(kind, n, rng):
    """Return the places of the samples that remain."""
    present = np.ones(n, dtype=bool)
    if kind.endswith("missing"):
        present[rng.permutation(n)[: round(n * float(kind.split()[0]) / 100)]] = False
    if kind.endswith("gaps"):
        gap = GAP * n // SAMPLES
        for begin in rng.integers(0, n - gap, GAPS):
            present[begin : begin + gap] = False
    return np.flatnonzero(present)


def record(name, seed, n):
    """Return {kind: {m: (variance over true variance, degrees of freedom, terms, interval contains the truth, bridged)}}."""
    noise, missing = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(2))
    x = NOISES[name].sample(n, 1 / RATE, noise)
    curves = {}
    for kind in KINDS:
        place = kept(kind, n, missing)
        breaks = np.flatnonzero(np.diff(place) > 1) + 1
        curve = allan(x[place], 1 / RATE, breaks=breaks.tolist(), time=place * round(1e9 / RATE))
        true = NOISES[name].allan_variance(curve.averaging_time, 1 / RATE)
        inside = (curve.lower**2 <= true) & (true <= curve.upper**2)
        parts = np.diff([0, *breaks, place.size])
        whole = place[-1] - place[0] + 2 - 2 * curve.factor
        thin = np.maximum(parts[:, None] + 1 - 2 * curve.factor, 0).sum(axis=0) < BRIDGE * whole
        rows = zip(curve.deviation**2 / true, curve.degrees_of_freedom, curve.terms, inside, thin, strict=True)
        curves[kind] = dict(zip(curve.factor.tolist(), rows, strict=True))
    return curves


def study(records=400, n=SAMPLES, workers=1):
    """Return the tables: a summary, and one table of each noise and kind of record."""
    tables = {}
    for name in NOISES:
        count = records if name == next(iter(NOISES)) else max(records // 2, 2)
        curves = over_records(record, [(name, seed, n) for seed in range(count)], workers)
        tables |= {(name, kind): _table(curves, name, kind) for kind in KINDS}
    return (_summary(tables), *tables.values())


def _columns(curves, kind, m):
    """Return arrays of ratio, degrees of freedom, terms, inside, bridged, over the records that have this factor."""
    cells = [record[kind][m] for record in curves if m in record[kind]]
    return tuple(np.array(column) for column in zip(*cells, strict=True))


def _table(curves, name, kind):
    rows = []
    for m in sorted({m for record in curves for m in record[kind]}):
        ratio, edf, terms, inside, thin = _columns(curves, kind, m)
        if ratio.size < max(len(curves) // 2, 2):
            continue
        spread = float(ratio.var(ddof=1))
        share = Share(int(thin.sum()), ratio.size)
        # Records that are not bridged lose no degrees of freedom.
        loss = whole_loss = "–"
        if share.value > 0.9:
            loss = 2 / spread / float(edf.mean())
            base, _, base_terms, *_ = _columns(curves, "whole", m)
            whole_loss = float(base.var(ddof=1)) / spread * float(base_terms.mean() / terms.mean())
        rows.append((
            m, f"{m / RATE:g}", ratio.size, f"{100 * share.value:.0f} %",
            Mean(float(ratio.mean()), float(np.sqrt(spread / ratio.size))), float(edf.mean()),
            float(np.sqrt(spread / np.mean(2 / edf))), loss, whole_loss, Share(int(inside.sum()), ratio.size),
        ))  # fmt: skip
    note = "" if (name, kind) != (next(iter(NOISES)), KINDS[0]) else (
        "Mean: variance over true variance, with its standard error; the goal is 1. Scatter: standard deviation of that ratio over the "
        "standard deviation that the degrees of freedom predict; the goal is 1. A curve omits averaging times whose variance is below 0, "
        "so the mean is too large where the number of records is smaller. True over given: the factor on the degrees of freedom that would "
        "make the scatter as predicted; the goal is 1, and with more the intervals are too wide. Per term, against whole records: degrees "
        "of freedom for each second difference, calculated from the scatter, over the same figure of the whole records."
    )  # fmt: skip
    return Table(
        f"{name}, {kind}",
        (
            "m", "averaging time, s", "records", "bridged", "mean", "degrees of freedom", "scatter", "true over given degrees of freedom",
            "degrees of freedom per term, against whole records", "coverage of the 95 % interval",
        ),
        tuple(rows), note,
    )  # fmt: skip


def _summary(tables):
    """Return bias, coverage and degrees of freedom of each noise and kind of record."""
    rows = []
    for (name, kind), table in tables.items():
        most = max(table.column("records"))
        columns = zip(*(table.column(h) for h in ("mean", "records", "m")), strict=True)
        off, m = max((abs(mean.off), m) for mean, count, m in columns if count == most)
        rows.append(
            (f"{name}, {kind}: largest bias", "below 4 standard errors", f"{off:.1f}, m = {m}", verdict(off < 4))
        )
        least = min(table.column("coverage of the 95 % interval"), key=lambda share: share.value)
        rows.append((f"{name}, {kind}: lowest coverage of an octave", "95 %", least, "–"))
        for heading in ("true over given degrees of freedom", "degrees of freedom per term, against whole records"):
            ratios = [
                ratio
                for ratio, freedom in zip(table.column(heading), table.column("degrees of freedom"), strict=True)
                if ratio != "–" and freedom >= FEW
            ]
            if ratios:
                result = f"{np.median(ratios):.2f} ({min(ratios):.3g}–{max(ratios):.3g})"
                rows.append((f"{name}, {kind}: {heading}, median (smallest–largest)", "1", result, "–"))
    return Table("Goals", GOALS, tuple(rows))


if __name__ == "__main__":
    main(
        __file__, QUESTION, study, 400,
        lambda n: f"seeds 0..{n - 1}, n = {n} records of {SAMPLES} samples of N + B + K, half as many of each other noise",
    )  # fmt: skip
