"""All findings of one log side by side, and a verdict for each axis."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from imuwb.analysis import Table
from imuwb.texts import coefficient_text
from imuwb.units import coefficient_units

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.analysis import Finding, Review

LETTERS = "QNBK"
SUSPICIOUS = "SUSPICIOUS"  #: what a remark begins with that puts the figures in doubt
_NAMES = {"allan": "Allan", "likelihood": "likelihood", "wavelet": "wavelet variance", "psd": "PSD"}


def axes(findings: Sequence[Finding]) -> dict[str, dict[str, Any]]:
    """Return {axis: estimators, headline, its coefficients, remarks}."""
    found: dict[str, dict[str, Any]] = {}
    for finding in findings:
        axis = found.setdefault(finding.axis, {"headline": None, "coefficients": {}, "estimators": {}, "verdict": []})
        if finding.coefficients:
            axis["estimators"][finding.source] = dict(finding.coefficients)
        if finding.headline:
            axis["headline"], axis["coefficients"] = finding.source, dict(finding.coefficients)
        axis["verdict"] += finding.remarks
    return found


def draw(found: dict[str, dict[str, Any]], findings: Sequence[Finding], review: Review) -> None:
    """Show the verdicts, and what the estimators give (Quinchia, tables 3 and 4 beside each other)."""
    rows: list[tuple[str, ...]] = []
    also: list[tuple[str, ...]] = []
    for axis in found:
        acting = [r for f in findings if f.axis == axis and f.coefficients for r in f.remarks]
        urgent = [r for r in acting[1:] if r.startswith(SUSPICIOUS)]
        rest = [r for r in acting[1:] if r not in urgent]
        rows.append((axis, acting[0] if acting else "—", "; ".join([*urgent, *rest]) or "nothing to act on"))
        also += [(axis, f.source, r) for f in findings if f.axis == axis and not f.coefficients for r in f.remarks]
    doubtful = any(SUSPICIOUS in cell for row in rows for cell in row)
    caption = f"{SUSPICIOUS}: look before you trust the figures." if doubtful else ""
    review.table(Table("Verdicts", ("axis", "what rules", "what to know"), tuple(rows), caption, wide=True))
    lines: list[tuple[str, ...]] = []
    for axis, content in found.items():
        for source, coefficients in content["estimators"].items():
            name = str(_NAMES.get(source, source)) + (" (headline)" if source == content["headline"] else "")
            cells = (
                coefficient_text(coefficients[x], coefficient_units(axis, x)[1]) if x in coefficients else "—"
                for x in LETTERS
            )
            lines.append((axis, name, *cells))
    headings = ("axis", "estimator", "Q quantization", "N random walk", "B bias instability", "K rate random walk")
    caption = "Value [interval]; < is an upper limit. The headline goes into the error model: those of its terms whose interval does not begin at 0."
    review.table(Table("Noise by estimator", headings, tuple(lines), caption, wide=True))
    review.table(Table("Also seen", ("axis", "by", "remark"), tuple(also)))
