"""The recording of an outage replay: drift first, then the drive in time, consistency, errors, budget, outages and filters."""

import rerun as rr

from imuwb.analysis import Review
from imuwb.colors import SUBGRID
from imuwb.notes import Note
from imuwb_plugins.outage import figures, paper, tables
from imuwb_plugins.outage.result import Result

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
    review.note(Note("drive", result.drive.about))
    _drive(result, review)
    if result.on_map:
        _map(result, review)
    review.tab("Consistency")
    for own in result.summary:
        review.figure(figures.consistency(own))
        review.table(tables.consistency(own))
    if result.motion is not None:
        review.tab("Noise in motion")
        review.table(tables.motion(result.motion))
    review.tab("Errors")
    for name in result.ranked(result.samples.errors):
        review.figure(figures.errors(result, name))
    review.tab("Budget")
    review.figure(figures.budget(result.budget))
    review.table(tables.budget(result.budget))
    review.tab("Outages")
    review.table(tables.outages(result))
    if len(result.outages) <= FEW:
        paper.draw(sorted(result.outages, key=paper.begin), result.published, review)
        paper.pictures(result.pictures, review)
    _comparison(result, review)
    _filters(result, review)


def _drive(result: Result, review: Review) -> None:
    """Show the drive in time: the vehicle, the filters in some outages, and charts on the same cursor."""
    review.tab("Drive")
    own = result.drive
    review.scene(own.scene)
    for series in own.charts:
        review.series(series)
    for span in own.spans:
        review.span(span)
    for event in own.events:
        review.event(event)


def _map(result: Result, review: Review) -> None:
    """Show the reference, and the filters in the named outages, on a map."""
    review.tab("Map")
    review.map_track("reference", result.reference_track, SUBGRID)
    for episode in result.drive.scene.episodes:
        for belief in episode.beliefs if episode.name else ():
            review.map_track(f"{belief.name}, {episode.name}", belief.position, belief.color)


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
