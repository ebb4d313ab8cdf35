"""The views of a tab with a scene: the scene, the plan, what holds now, and the charts beside them on the same cursor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TypeVar

import rerun as rr
import rerun.blueprint as rrb

from imuwb.review.figures.sizes import LEGEND_ROW, text_width
from imuwb.review.scene.frames import Frames
from imuwb.review.scene.plan import plan
from imuwb.review.scene.stage import CLEARED, announced, groups, stage
from imuwb.review.scene.timelines import Timelines, seconds
from imuwb.review.tables.markdown import caption_text
from imuwb.scene import Scene

HALVES = (1.2, 1.0)  #: shares of the width: the scene, the charts
SCENE_SHARES = (1.65, 1.0)  #: shares of the height: the scene, what is below it
CHART_FRAME = 56.0  #: height of a chart without the rows of its legend, px
LOWEST, HIGHEST = 150.0, 230.0  #: least heights of a chart, and of the first one, px
FIELD = 0.78  #: share of the height of a chart's field that the viewer gives a legend
BESIDE = 46.0  #: height that charts beside each other have more, because lines have no room beside the legend, px
ICONS = 110.0  #: width of what stands beside the title of a chart, px
BELOW = (1.0, 1.25, 0.75)  #: shares of the width: the plan, what holds now, the events
MOST_ROWS = 4  #: of charts: a legend needs some height
PLAN, NOW = "The whole track", "Now"
T = TypeVar("T")


@dataclass(slots=True)
class Theatre:
    """The views of a scene."""

    scene: rrb.View
    below: list[rrb.View] = field(default_factory=list[rrb.View])

    @staticmethod
    def of(scene: Scene, recording: rr.RecordingStream, timelines: Timelines, path: str) -> Theatre:
        """Log a scene, its plan and its captions."""
        view = stage(scene, recording, timelines, path)
        above = plan(scene, recording, timelines, f"{path}_plan", PLAN)
        return Theatre(view, [above, _captions(scene, recording, timelines, f"{path}_now")])

    def layout(self, name: str, series: Sequence[rrb.View], entries: Sequence[int]) -> rrb.Vertical:
        """Return the arrangement: the scene at the left, the charts at the right, the first of them the highest.

        Args:
            name: of the tab.
            series: the charts.
            entries: number of rows of the legend of each chart: the viewer cuts off what is higher than its chart. Two charts
                beside each other have more room, because lines have none beside the legend.
        """
        left = rrb.Vertical(
            self.scene, rrb.Horizontal(*self.below, column_shares=BELOW[: len(self.below)]), row_shares=SCENE_SHARES
        )
        main: rrb.Container = left
        if series:
            rows = _rows([*zip(series, entries, strict=True)])
            heights = [
                max(CHART_FRAME + LEGEND_ROW / FIELD * max(n for _, n in row) + BESIDE * (len(row) - 1), LOWEST)
                for row in rows
            ]
            heights[0] = max(heights[0], HIGHEST)
            views = [_side_by_side([view for view, _ in row]) for row in rows]
            main = rrb.Horizontal(left, rrb.Vertical(*views, row_shares=heights), column_shares=HALVES, name=name)
        return rrb.Vertical(main, name=name)


def _rows(charts: Sequence[T]) -> list[Sequence[T]]:
    """Return charts, at most four rows: those after the first are in pairs as far as it must be."""
    pairs = max(len(charts) - MOST_ROWS, 0)
    ends = [0, *range(1, 1 + 2 * pairs, 2), *range(1 + 2 * pairs, len(charts) + 1)]
    return [charts[a:b] for a, b in pairwise(ends)]


def _side_by_side(views: Sequence[rrb.View]) -> rrb.View | rrb.Container:
    """Return views in a row, each as wide as its title needs."""
    if len(views) == 1:
        return views[0]
    return rrb.Horizontal(*views, column_shares=[text_width(str(view.name)) + ICONS for view in views])


def _captions(scene: Scene, recording: rr.RecordingStream, timelines: Timelines, path: str) -> rrb.View:
    """Keep the text that changes in time."""
    recording.log(path, rr.TextDocument.from_fields(media_type=rr.MediaType.MARKDOWN), static=True)
    for episodes, on in groups(scene):
        frames = Frames((rr.TextDocument,))
        if on == ("",):  # the text of the whole log is there from its begin
            frames.add(int(scene.body.time[0]), {"text": [caption_text(scene.about)]})
        for episode in episodes:
            if episode.name:
                frames.add(announced(scene, episode), {"text": [caption_text(episode.about)]})
            times = episode.beliefs[0].time.tolist() if episode.beliefs else []
            for time, caption in zip(times, episode.captions, strict=True):
                frames.add(time, {"text": [caption_text(caption)]})
            frames.add(episode.end + seconds(CLEARED), {"text": [caption_text(scene.about)]})
        frames.keep(timelines, path, on)
    return rrb.TextDocumentView(origin=path, name=NOW)
