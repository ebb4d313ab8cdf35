"""A recording that shows an answer without a log, such as that of an error model or of a plan."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from imuwb import __version__
from imuwb.analysis import Answer, Review
from imuwb.review.answers.document import json_text
from imuwb.review.answers.panel import WHOLE_HEIGHT, Origin, panel
from imuwb.review.recording.properties import properties, recording_name
from imuwb.review.recording.review import RecordingReview


def write_answer(
    output: Path,
    tab: str,
    answer: Answer,
    origin: Origin,
    names: Sequence[str],
    content: Mapping[str, object],
    draw: Callable[[Review], None],
) -> None:
    """Write a recording of one tab.

    Args:
        output: its file.
        tab: name of the tab.
        answer: shown on the first tab.
        origin: of the answer.
        names: what it is about, for the name of the recording.
        content: the result, as JSON in the recording.
        draw: shows the figures and tables.
    """
    review = RecordingReview(output)
    try:
        review.tab(tab)
        draw(review)
        review.summary(panel(answer, origin, height=WHOLE_HEIGHT))
        stated = properties(origin.analysis, __version__, None, (), answer, ())
        name = f"{recording_name(origin.analysis, (), answer)} · {', '.join(names)}"
        review.state(name, {**stated, "log": list(names)}, json_text({"analysis": origin.analysis, **content}))
        review.close()
    except BaseException:
        review.discard()
        raise
