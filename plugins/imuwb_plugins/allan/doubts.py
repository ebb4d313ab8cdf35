"""What puts the error model of an Allan analysis in doubt."""

from imuwb.analysis import SUSPICIOUS
from imuwb.health import Doubts, model_doubts
from imuwb.notes import Note
from imuwb.stochastic import ImuErrorModel
from imuwb_plugins.allan.remarks import findings
from imuwb_plugins.allan.result import Result


def doubts_of(result: Result, model: ImuErrorModel) -> Doubts:
    """Return what speaks against a model of this result: the record itself, axes without a fit, and suspicious remarks."""
    missing = [Note("no-fit", f"{axis}: {r.why_no_fit}") for axis, r in result.axes.items() if r.why_no_fit]
    remarks = [
        Note(remark.id, f"{finding.axis}: {remark.removeprefix(SUSPICIOUS)}")
        for finding in findings(result)
        for remark in finding.remarks
        if isinstance(remark, Note) and remark.startswith(SUSPICIOUS) and remark.id != "no-fit"
    ]
    return result.doubts + model_doubts(model) + Doubts(slight=(*missing, *remarks))
