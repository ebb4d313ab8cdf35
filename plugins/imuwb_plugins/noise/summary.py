"""All findings of one log side by side, and a verdict for each axis."""

from collections.abc import Mapping, Sequence

from imuwb.analysis import SUSPICIOUS, Finding, Review, Table
from imuwb.texts import coefficient_text
from imuwb.units import coefficient_units
from imuwb_plugins.noise.result import NoiseAxis

LETTERS = "QNBK"
_NAMES = {"allan": "Allan", "likelihood": "likelihood", "wavelet": "wavelet variance", "psd": "PSD"}


def axes(findings: Sequence[Finding]) -> dict[str, NoiseAxis]:
    """Return the estimates and remarks of each axis."""
    names = dict.fromkeys(finding.axis for finding in findings)
    return {name: _axis([finding for finding in findings if finding.axis == name]) for name in names}


def _axis(findings: Sequence[Finding]) -> NoiseAxis:
    headline = next((f for f in findings if f.headline), None)
    first, *rest = [r for f in findings if f.coefficients for r in f.remarks] or [""]
    doubts = [r for r in rest if r.startswith(SUSPICIOUS)]
    return NoiseAxis(
        None if headline is None else headline.source, {} if headline is None else headline.coefficients,
        {f.source: f.coefficients for f in findings if f.coefficients}, tuple(r for f in findings for r in f.remarks),
        (first, *doubts, *(r for r in rest if r not in doubts)),
        tuple((f.source, r) for f in findings if not f.coefficients for r in f.remarks),
    )  # fmt: skip


def draw(estimates: Mapping[str, NoiseAxis], review: Review) -> None:
    """Show the verdicts, and the estimators side by side (as Quinchia, tables 3 and 4)."""
    review.table(_verdicts(estimates))
    review.table(_estimators(estimates))
    rows = tuple((name, *other) for name, axis in estimates.items() for other in axis.others)
    review.table(Table("Other analyses", ("axis", "analysis", "remark"), rows))


def _verdicts(estimates: Mapping[str, NoiseAxis]) -> Table:
    rows = tuple(
        (name, axis.remarks[0] or "—", "; ".join(axis.remarks[1:]) or "nothing to act on")
        for name, axis in estimates.items()
    )
    doubtful = any(SUSPICIOUS in cell for row in rows for cell in row)
    caption = f"{SUSPICIOUS}look at the figures before you use the coefficients." if doubtful else ""
    return Table("Verdicts", ("axis", "dominant process by averaging time", "remarks"), rows, caption)


def _estimators(estimates: Mapping[str, NoiseAxis]) -> Table:
    rows: list[tuple[str, ...]] = []
    for name, axis in estimates.items():
        for source, coefficients in axis.estimators.items():
            label = _NAMES.get(source, source) + (" (headline)" if source == axis.headline else "")
            cells = (
                coefficient_text(coefficients[x], coefficient_units(name, x)[1]) if x in coefficients else "—"
                for x in LETTERS
            )
            rows.append((name, label, *cells))
    headings = ("axis", "estimator", "Q quantization", "N random walk", "B bias instability", "K rate random walk")
    caption = "Value [interval]; < is an upper limit. The error model takes those terms of the headline whose intervals do not begin at 0."
    return Table("Noise by estimator", headings, tuple(rows), caption)
