"""The review as a Rerun recording: tabs of figures, series, tables and notes, with their blueprint inside."""

from __future__ import annotations

import math
import socket
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from imuwb.errors import ImuwbError
from imuwb.review.chart import Chart
from imuwb.review.envelope import envelope
from imuwb.review.rrd import is_whole, why_cut
from imuwb.writers.beside import partial

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from imuwb.analysis import Figure, Floats, Series, Table

EARTH_RADIUS = 6_371_000.0  #: m; a track is drawn on a plane, where a sphere is good enough
ROWS = 65_536  #: of a chunk
BACKGROUND = (22, 22, 26)


@dataclass(slots=True)
class _Tab:
    """What one analysis put on its tab."""

    name: str
    path: str
    figures: list[rrb.View] = field(default_factory=list[rrb.View])
    series: list[rrb.View] = field(default_factory=list[rrb.View])
    texts: list[rrb.View] = field(default_factory=list[rrb.View])
    wide: list[rrb.View] = field(default_factory=list[rrb.View])
    notes: list[str] = field(default_factory=list[str])
    tracks: int = 0
    charts: int = 0
    origin: Floats | None = None  #: latitude rad, longitude rad, height m, from which tracks are drawn

    def layout(self) -> rrb.Container | rrb.View | None:
        rows: list[rrb.Container | rrb.View] = []
        shares: list[float] = []
        for at in range(0, len(self.figures), 2):
            pair = self.figures[at : at + 2]
            rows.append(rrb.Horizontal(*pair) if len(pair) > 1 else pair[0])
            shares.append(3.0)
        rows.extend(self.series)
        shares.extend([1.6] * len(self.series))
        rows.extend(self.wide)
        shares.extend([1.9] * len(self.wide))
        for at in range(0, len(self.texts), 2):  # two beside each other, the first table the widest
            pair = self.texts[at : at + 2]
            rows.append(rrb.Horizontal(*pair, column_shares=[1.7, 1.0]) if len(pair) > 1 else pair[0])
            shares.append(1.5)
        if not rows:
            return None
        return rrb.Vertical(*rows, row_shares=shares, name=self.name)


def _require_viewer(address: str) -> None:
    """Raise ImuwbError unless something listens there: the viewer's own library would wait without end."""
    place = urlsplit(address)
    try:
        socket.create_connection((place.hostname or "127.0.0.1", place.port or 9876), timeout=2).close()
    except OSError as error:
        message = f"--live: no viewer listens at {place.hostname}:{place.port}; start one with: rerun --bind 127.0.0.1"
        raise ImuwbError(message) from error


def _nobody(what: Table | str) -> None:
    """Show nothing: there is no terminal."""
    del what


class RecordingReview:
    """Shows results in a recording file, written beside its place and put there when it is whole."""

    def __init__(
        self,
        output: Path,
        *,
        live: str | None = None,
        show: Callable[[Table | str], None] | None = None,
        application: str = "imuwb",
        recording: str | None = None,
    ) -> None:
        """Open a recording.

        Args:
            output: the file to be; it appears when ``close`` is called.
            live: address of a running viewer that sees it too, such as ``rerun+http://127.0.0.1:9876/proxy``.
            show: called with each table and note, for the terminal.
            application: whose recording it is, to the viewer.
            recording: its identity; None: a new one.
        """
        if live is not None:
            _require_viewer(live)
        self.output = output.resolve()
        self._partial = partial(self.output)
        self._show = show or _nobody
        self._stream = rr.RecordingStream(application, recording_id=recording, send_properties=True)
        try:
            self._partial.touch()
            sinks: list[rr.FileSink | rr.GrpcSink] = [rr.FileSink(str(self._partial))]
            if live is not None:
                sinks.append(rr.GrpcSink(live))
            self._stream.set_sinks(*sinks)
        except OSError as error:
            message = f"{output}: cannot be written: {error.strerror}; choose another place with --output"
            raise ImuwbError(message) from error
        self._tabs: list[_Tab] = []
        self._timeline: str | None = None
        self.notes: list[str] = []
        self.tab("Result")

    @property
    def recording(self) -> rr.RecordingStream:
        """The recording itself."""
        return self._stream

    def tab(self, name: str) -> None:
        """Put what follows on a tab of that name."""
        path = "".join(c if c.isalnum() else "_" for c in name.lower())
        self._tabs.append(_Tab(name, f"/{path}"))

    @property
    def _tab(self) -> _Tab:
        return self._tabs[-1]

    def figure(self, figure: Figure) -> None:
        """Show a figure."""
        path = f"{self._tab.path}/figure_{len(self._tab.figures)}"
        drawing = Chart(figure)
        drawing.draw(self._stream, path)
        x, y = drawing.bounds()
        self._tab.figures.append(
            rrb.Spatial2DView(
                origin=path, name=figure.title, visual_bounds=rrb.VisualBounds2D(x_range=x, y_range=y),
                background=rrb.Background(color=BACKGROUND, kind="SolidColor"),
            )
        )  # fmt: skip

    def series(self, series: Series) -> None:
        """Show quantities over time, long ones as envelopes."""
        path = f"{self._tab.path}/series_{len(self._tab.series)}"
        time, values = envelope(series.time, series.values)
        names = [f"{name} [{series.unit}]" for name in series.names]
        self._stream.log(
            path,
            rr.SeriesLines(
                names=names, colors=list(series.colors) or None, aggregation_policy=rr.components.AggregationPolicy.MinMax,
                widths=[1.2] * len(names),
            ),
            static=True,
        )  # fmt: skip
        self._timeline = self._timeline or ("time" if series.epoch == "unix" else "time_since_start")
        for start in range(0, time.size, ROWS):
            rows = slice(start, start + ROWS)
            stamp = time[rows]
            index = (
                rr.TimeColumn("time", timestamp=stamp.astype("datetime64[ns]"))
                if series.epoch == "unix"
                else rr.TimeColumn("time_since_start", duration=stamp.astype("timedelta64[ns]"))
            )
            scalars = rr.Scalars.columns(scalars=values[rows].ravel()).partition([values.shape[1]] * stamp.size)
            self._stream.send_columns(path, [index], scalars)
        whole = rr.TimeRange(start=rr.TimeRangeBoundary.infinite(), end=rr.TimeRangeBoundary.infinite())
        self._tab.series.append(
            rrb.TimeSeriesView(
                origin=path, name=f"{series.title} [{series.unit}]", axis_x=rrb.TimeAxis(view_range=whole),
                plot_legend=rrb.PlotLegend(corner="RightTop"),
            )
        )  # fmt: skip

    def table(self, table: Table) -> None:
        """Show a table."""
        self._show(table)
        cells = [table.headings, ["---"] * len(table.headings), *table.rows]
        lines = ["| " + " | ".join(_literal(cell) for cell in row) + " |" for row in cells]
        self._text_on(
            self._tab,
            table.title,
            "\n".join(lines) + (f"\n\n{table.caption}" if table.caption else ""),
            wide=table.wide,
        )

    def note(self, text: str) -> None:
        """Say something a reader must know."""
        self._show(text)
        self.notes.append(text)
        self._tab.notes.append(text)

    def track(self, name: str, position: Floats, color: tuple[int, int, int], label: str = "") -> None:
        """Show a trajectory in local east and north, metres from the first point of the tab's first; a label at its end."""
        path = f"{self._tab.path}/track"
        start = self._tab.origin = position[0] if self._tab.origin is None else self._tab.origin
        east = (position[:, 1] - start[1]) * math.cos(start[0]) * EARTH_RADIUS
        north = (position[:, 0] - start[0]) * EARTH_RADIUS
        points = np.stack([east, -north], axis=1)
        if len(points) > 20_000:  # noqa: PLR2004 - a line on a screen has no more points
            points = points[:: len(points) // 10_000]
        self._stream.log(
            f"{path}/{self._tab.tracks}_{name.strip('/').replace('/', '_')}",
            rr.LineStrips2D([points], colors=[color], radii=rr.Radius.ui_points(1.5)),
            static=True,
        )
        if label:
            self._stream.log(
                f"{path}/labels/{self._tab.tracks}",
                rr.Points2D(
                    [points[-1]], labels=[label], colors=[color], radii=rr.Radius.ui_points(3.0), show_labels=True
                ),
                static=True,
            )
        if not self._tab.tracks:
            low, high = points.min(axis=0), points.max(axis=0)
            span = max(float((high - low).max()), 1.0)
            bar = 10 ** math.floor(math.log10(span / 3))
            bar = next(b for b in (5 * bar, 2 * bar, bar) if b <= span / 2)
            left, bottom = float(low[0]), float(high[1]) + span * 0.08
            ruler = [(left, bottom), (left + bar, bottom)]
            self._stream.log(
                f"{path}/scale",
                rr.LineStrips2D([ruler], colors=[(225, 225, 228)], radii=rr.Radius.ui_points(1.5)),
                static=True,
            )
            labels = [((left + bar / 2, bottom + span * 0.04), f"{bar:g} m"), (tuple(points[0]), "start")]
            self._stream.log(
                f"{path}/texts",
                rr.Points2D([p for p, _ in labels], labels=[t for _, t in labels], colors=[(225, 225, 228)] * 2,
                            radii=rr.Radius.ui_points(2.0), show_labels=True),
                static=True,
            )  # fmt: skip
            air = span * 0.15  # for the labels, which hang over
            bounds = rrb.VisualBounds2D(
                x_range=[float(low[0]) - air, float(high[0]) + air], y_range=[float(low[1]) - air, bottom + air]
            )
            self._tab.figures.append(
                rrb.Spatial2DView(origin=path, name=f"Track of {name}: east to the right, north up", visual_bounds=bounds,
                                  background=rrb.Background(color=BACKGROUND, kind="SolidColor"))
            )  # fmt: skip
        self._tab.tracks += 1

    def map_track(self, name: str, position: Floats, color: tuple[int, int, int]) -> None:
        """Show a trajectory on a map, which the viewer fetches from the network."""
        path = f"{self._tab.path}/map"
        points = np.degrees(position[:: max(1, len(position) // 10_000), :2])
        self._stream.log(
            f"{path}/{self._tab.charts}_{name.strip('/').replace('/', '_').replace(' ', '_')}",
            rr.GeoLineStrings(lat_lon=[points], colors=[color], radii=rr.Radius.ui_points(2.0)),
            static=True,
        )
        if not self._tab.charts:
            self._tab.figures.append(rrb.MapView(origin=path, name=f"Map of {name}"))
        self._tab.charts += 1

    def close(self) -> Path:
        """Write the blueprint and put the file in its place; the review cannot be used behind this."""
        for tab in self._tabs:
            if tab.notes:
                self._text_on(tab, "Notes", "\n".join(f"- {note}" for note in tab.notes))
                tab.texts.insert(1, tab.texts.pop())  # beside the first table, where they are seen
        views = [layout for tab in self._tabs if (layout := tab.layout()) is not None]
        panel = rrb.TimePanel(state="collapsed", play_state="paused", timeline=self._timeline)
        blueprint = rrb.Blueprint(
            rrb.Tabs(*views), rrb.BlueprintPanel(state="collapsed"), rrb.SelectionPanel(state="collapsed"), panel
        )
        self._stream.send_blueprint(blueprint)
        with suppress(RuntimeError):  # the thread that writes has ended: what is in the file tells
            self._stream.flush()
        self._disconnect()
        if not is_whole(self._partial):
            why = why_cut(self._partial)
            self.discard()
            message = f"{self.output}: cannot be written: {why}"
            raise ImuwbError(message)
        try:
            self._partial.replace(self.output)
        except OSError as error:
            self.discard()
            message = f"{self.output}: cannot be written: {error.strerror}"
            raise ImuwbError(message) from error
        return self.output

    def discard(self) -> None:
        """Leave nothing behind."""
        self._disconnect()
        self._partial.unlink(missing_ok=True)

    def _disconnect(self) -> None:
        with suppress(RuntimeError):  # as in ``close``
            self._stream.disconnect()

    def _text_on(self, tab: _Tab, name: str, markdown: str, *, wide: bool = False) -> None:
        path = f"{tab.path}/text_{len(tab.texts) + len(tab.wide)}"
        self._stream.log(path, rr.TextDocument(markdown, media_type=rr.MediaType.MARKDOWN), static=True)
        (tab.wide if wide else tab.texts).append(rrb.TextDocumentView(origin=path, name=name))


def _literal(cell: str) -> str:
    """Return a cell whose signs are not taken for markup."""
    return cell if set(cell) <= {"-"} else cell.replace("|", "\\|").replace("*", "\\*").replace("_", "\\_")
