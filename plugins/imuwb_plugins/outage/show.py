"""The recording of an outage replay: drift first, then consistency, errors, budget, biases, tracks, outages and filters."""

import rerun as rr

from imuwb.analysis import Review
from imuwb.colors import INK, SUBGRID
from imuwb.notes import Note
from imuwb.texts import number_text
from imuwb_plugins.outage import figures, tables
from imuwb_plugins.outage.figures import color_of
from imuwb_plugins.outage.result import Result, Tracks

FEW = 20  #: outages, up to which each is compared as in the paper


def draw(result: Result, review: Review) -> None:
    """Show the drift of each filter, whether its sigma is right, and the details."""
    for own in result.summary:
        review.table(tables.drift(own, result))
    if result.whole_run:
        review.table(tables.whole_run(result))
    for own in result.summary:
        review.figure(figures.drift(own))
    for note in (*result.verdicts, *result.notes):
        review.note(note)
    review.tab("Consistency")
    for own in result.summary:
        review.figure(figures.consistency(own))
        review.table(tables.consistency(own))
    if result.motion is not None:
        review.tab("Noise in motion")
        review.table(tables.motion(result.motion))
    review.tab("Errors")
    for name in result.samples.errors:
        review.figure(figures.errors(result, name))
    review.tab("Budget")
    review.figure(figures.budget(result.budget))
    review.table(tables.budget(result.budget))
    review.tab("Biases")
    for series in figures.sensor_errors(result.sensor_errors):
        review.series(series)
    _tracks(result, review)
    review.tab("Outages")
    review.table(tables.outages(result))
    if len(result.outages) <= FEW:
        review.figure(figures.each_outage(result))
        review.table(tables.published(result))
    _comparison(result, review)
    _filters(result, review)


def _tracks(result: Result, review: Review) -> None:
    """Show the reference, and the tracks of the filters in some outages."""
    review.tab("Tracks")
    review.track("reference", result.reference_track, INK)
    if result.on_map:
        review.map_track("reference", result.reference_track, SUBGRID)
    for own in result.tracks:
        _tracks_of(own, result, review)


def _tracks_of(own: Tracks, result: Result, review: Review) -> None:
    for outage in own.outages:
        best, worst = outage.best, outage.worst
        label = f"{best} {number_text(outage.ends[best])} m, {worst} {number_text(outage.ends[worst])} m"
        for name in sorted(outage.positions, key=lambda name: name == best):  # the best one, with the label, on top
            position, title = outage.positions[name], f"{name} at {outage.start:.0f} s"
            if result.on_map:
                review.map_track(title, position, color_of(name))
            review.track(title.replace(" ", "_"), position, color_of(name), label if name == best else "")
    text = (
        f"tracks: {len(own.outages)} of {own.count} outages of {own.duration:g} s; the labels show the smallest and the largest "
        "error at the end"
    )
    review.note(Note("tracks", text))


def _comparison(result: Result, review: Review) -> None:
    review.tab("Comparison")
    for own in result.summary:
        if own.choice is not None:
            review.table(tables.choice(own.choice))
        if own.paired:
            review.table(tables.paired(own))
        if own.by_motion:
            review.table(tables.by_motion(own))


def _filters(result: Result, review: Review) -> None:
    review.tab("Filters")
    review.table(tables.filters(result))
    for own in result.filters:
        path = f"filter_models/{own.name.replace(' ', '_')}"
        review.recording.log(path, rr.TextDocument(own.document), static=True)
