"""Is the Allan variance of a record with samples missing biased, and are its degrees of freedom right?

60,000 samples at 100 Hz of white noise, flicker and a random walk, each of which rules about a third of the averaging times:
whole; with 5 and 20 % of the samples taken out at random; and with three gaps of a minute each at random places. Each is
``allan(values, dt, breaks=..., time=...)`` at octaves; the same seed is the same noise. Gaps are no part of the noise, so
wanted is a bias of 0, within chance, at every octave.

Where gaps leave less than half of the second differences, an averaging time is bridged by means of the samples there are, and
the degrees of freedom are fewer, by what the noise within the means
takes. What the whole loss should be is printed twice: so that the scatter is as expected from the degrees of freedom, as
a multiple of those there are, and from the scatter of the whole records, which no noise type goes into. The same for white
noise alone, and for quantization above white noise, with half as many records: there what is missing adds most.

Command: ``python tests/studies/missing_samples.py`` (400 records: about 6 minutes in one process).
Seeds: record r uses ``SeedSequence(r).spawn(2)``, for the noise and for what is missing.
"""

from __future__ import annotations

import numpy as np
from study_report import Mean, Share, Table, main, over_records, verdict

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
FEW = 5.0  #: degrees of freedom; below, a scatter is ill described by them


def kept(kind, n, rng):
    """Return the places of the samples that are there."""
    there = np.ones(n, dtype=bool)
    if kind.endswith("missing"):
        there[rng.permutation(n)[: round(n * float(kind.split()[0]) / 100)]] = False
    if kind.endswith("gaps"):
        gap = GAP * n // SAMPLES
        for begin in rng.integers(0, n - gap, GAPS):
            there[begin : begin + gap] = False
    return np.flatnonzero(there)


def record(name, seed, n):
    """Return {kind: {m: (variance over the true one, degrees of freedom, true one in the interval, bridged)}}."""
    noise, missing = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(2))
    x = NOISES[name].sample(n, 1 / RATE, noise)
    found = {}
    for kind in KINDS:
        place = kept(kind, n, missing)
        breaks = np.flatnonzero(np.diff(place) > 1) + 1
        curve = allan(x[place], 1 / RATE, breaks=breaks.tolist(), time=place * round(1e9 / RATE))
        true = NOISES[name].allan_variance(curve.averaging_time, 1 / RATE)
        held = (curve.lower**2 <= true) & (true <= curve.upper**2)
        parts = np.diff([0, *breaks, place.size])
        whole = place[-1] - place[0] + 2 - 2 * curve.factor
        thin = np.maximum(parts[:, None] + 1 - 2 * curve.factor, 0).sum(axis=0) < BRIDGE * whole
        rows = zip(curve.deviation**2 / true, curve.degrees_of_freedom, curve.terms, held, thin, strict=True)
        found[kind] = dict(zip(curve.factor.tolist(), rows, strict=True))
    return found


def study(records=400, n=SAMPLES, workers=1):
    """Return the tables: a summary, and a table of each noise and kind of record."""
    tables = {}
    for name in NOISES:
        count = records if name == next(iter(NOISES)) else max(records // 2, 2)
        found = over_records(record, [(name, seed, n) for seed in range(count)], workers)
        tables |= {(name, kind): _table(found, name, kind) for kind in KINDS}
    return (_summary(tables), *tables.values())


def _columns(found, kind, m):
    """Return arrays of ratio, degrees of freedom, terms, held, bridged; one of each record that has this factor."""
    cells = [one[kind][m] for one in found if m in one[kind]]
    return tuple(np.array(column) for column in zip(*cells, strict=True))


def _table(found, name, kind):
    rows = []
    for m in sorted({m for one in found for m in one[kind]}):
        ratio, edf, terms, held, thin = _columns(found, kind, m)
        if ratio.size < max(len(found) // 2, 2):
            continue
        spread = float(ratio.var(ddof=1))
        share = Share(int(thin.sum()), ratio.size)
        # Of records that are bridged only; those that are not lose nothing.
        loss = whole_loss = "–"
        if share.value > 0.9:
            loss = 2 / spread / float(edf.mean())
            base, _, base_terms, *_ = _columns(found, "whole", m)
            whole_loss = float(base.var(ddof=1)) / spread * float(base_terms.mean() / terms.mean())
        rows.append((
            m, f"{m / RATE:g}", ratio.size, f"{100 * share.value:.0f} %",
            Mean(float(ratio.mean()), float(np.sqrt(spread / ratio.size))), float(edf.mean()),
            float(np.sqrt(spread / np.mean(2 / edf))), loss, whole_loss, Share(int(held.sum()), ratio.size),
        ))  # fmt: skip
    note = "" if (name, kind) != (next(iter(NOISES)), KINDS[0]) else (
        "Mean: of the variance over the true one, with its standard error; wanted 1. Scatter: its standard deviation over that "
        "expected from the degrees of freedom; wanted 1. An averaging time at which what is there gives a variance below 0 is left out of "
        "a curve, so where records are fewer the mean is too large. True over given: the factor on the degrees of freedom for which the "
        "scatter would be as expected; wanted 1, above it the intervals are too wide. Loss: the degrees of freedom of whole "
        "records that are left, by the scatter, over the share of terms that are left."
    )  # fmt: skip
    return Table(
        f"{name}, {kind}",
        (
            "m", "tau, s", "records", "bridged", "mean", "degrees of freedom", "scatter", "true over given degrees of freedom",
            "loss against whole records", "true value in the 95 % interval",
        ),
        tuple(rows), note,
    )  # fmt: skip


def _summary(tables):
    """Return bias, coverage and losses, noise by noise."""
    rows = []
    for (name, kind), table in tables.items():
        most = max(table.column("records"))
        columns = zip(*(table.column(h) for h in ("mean", "records", "m")), strict=True)
        off, m = max((abs(mean.off), m) for mean, count, m in columns if count == most)
        rows.append(
            (f"{name}, {kind}: largest bias", "below 4 standard errors", f"{off:.1f}, m = {m}", verdict(off < 4))
        )
        least = min(table.column("true value in the 95 % interval"), key=lambda share: share.value)
        rows.append((f"{name}, {kind}: least coverage of an octave", "95 %", least, "–"))
        wanted = {"true over given degrees of freedom": "1", "loss against whole records": "1"}
        for heading, aim in wanted.items():
            losses = [
                loss
                for loss, freedom in zip(table.column(heading), table.column("degrees of freedom"), strict=True)
                if loss != "–" and freedom >= FEW
            ]
            if losses:
                reached = f"{np.median(losses):.2f} ({min(losses):.3g}–{max(losses):.3g})"
                rows.append((f"{name}, {kind}: {heading}, median (least–largest)", aim, reached, "–"))
    return Table("What was wanted", ("figure", "wanted", "reached", "verdict"), tuple(rows))


if __name__ == "__main__":
    main(
        __file__,
        QUESTION,
        study,
        400,
        lambda n: f"seeds 0..{n - 1}, n = {n} records of {SAMPLES} samples of N + B + K, half as many of the others",
    )
