"""The review as a Rerun recording: tabs of figures, series, tables and notes; the recording contains its blueprint."""

import socket
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from urllib.parse import urlsplit

import pyarrow as pa
import rerun as rr
import rerun.blueprint as rrb

from imuwb.analysis import Bars, Figure, Series, Table
from imuwb.arrays import Floats
from imuwb.colors import Color
from imuwb.errors import ImuwbError
from imuwb.own_process import without
from imuwb.review.drawn.calls import Drawn, Item, Track
from imuwb.review.drawn.checked import check
from imuwb.review.figures import bars as bar_chart
from imuwb.review.figures import chart
from imuwb.review.figures.sizes import AREA, TITLE_BAR
from imuwb.review.recording import recorded
from imuwb.review.recording.recorded import Value
from imuwb.review.recording.rrd import is_whole, why_cut
from imuwb.review.recording.tab import Tab
from imuwb.review.scene.clock import Clock
from imuwb.review.scene.stage import SPEED, windows_of
from imuwb.review.scene.timelines import Timelines
from imuwb.scene import Event, Scene, Span
from imuwb.texts import markdown_block
from imuwb.writers.whole import Draft

PANEL = 670.0  #: px, width of the panel on the first tab; 80 columns fit
VIEWER_PORT = 9876
PATIENCE = 20.0  #: s in which the file grows, unless nothing more can be written
LEAVING = 5.0  #: s until the library lets go of a file, unless it never does
VIEWER_PATIENCE = 2.0  #: s; longest wait for a running viewer

with without("pandas"):
    pa.array([0])  # the first array looks for pandas


class RecordingReview:
    """Shows results in a recording file, which is written as a draft and gets its name when it is whole."""

    def __init__(
        self,
        output: str | Path,
        *,
        live: str | None = None,
        show: Callable[[Table | str], None] = lambda what: None,  # noqa: ARG005 - there is no terminal
        clock: Clock = Clock(),  # noqa: B008 - it is frozen
        application: str = "imuwb",
        recording: str | None = None,
    ) -> None:
        """Open a recording.

        Args:
            output: the file; it appears when ``close`` is called.
            live: address of a running viewer that also gets the recording, such as ``rerun+http://127.0.0.1:9876/proxy``.
            clock: of the first log; all series are on it.
            show: called with each table and note, for the terminal.
            application: name of the program that the viewer shows.
            recording: identity of the recording; None: a new one.

        Raises:
            ImuwbError: the file cannot be written, or no viewer runs at the address.
        """
        if live is not None:
            _require_viewer(live)
        self._draft = Draft.of(output)
        self._show = show
        self.recording = rr.RecordingStream(application, recording_id=recording, send_properties=True)
        try:
            sinks: list[rr.FileSink | rr.GrpcSink] = [rr.FileSink(str(self._draft.path))]
            if live is not None:
                sinks.append(rr.GrpcSink(live))
            self.recording.set_sinks(*sinks)
        except OSError as error:
            self._draft.discard()
            raise ImuwbError(
                f"{output}: cannot be written: {error.strerror}; choose another place with --output"
            ) from error
        self._tabs: list[Tab] = []
        self._clock = clock
        self._timelines = Timelines(clock)
        self.notes: list[str] = []
        self.drawn: list[Drawn] = []  #: all calls, for other renderers
        self._summary: rrb.Container | None = None
        self.tab("Result")

    @property
    def _tab(self) -> Tab:
        return self._tabs[-1]

    def tab(self, name: str) -> None:
        """Open a tab; all later calls show on this tab."""
        self._tabs.append(Tab.of(name))

    def _keep(self, item: Item) -> None:
        check(item)
        self.drawn.append(Drawn(self._tab.name, item))

    def figure(self, figure: Figure) -> None:
        """Show a figure."""
        self._keep(figure)
        self._tab.pictures.append(figure)

    def series(self, series: Series) -> None:
        """Show quantities over time. Long series are drawn as the envelopes of their extremes.

        Raises:
            ValueError: the series has another clock than the recording.
        """
        series = self._clock.on(series)
        self._keep(series)
        self._tab.quantities.append(series)

    def table(self, table: Table) -> None:
        """Show a table."""
        self._keep(table)
        self._show(table)
        self._tab.tables.append(table)

    def note(self, text: str) -> None:
        """State what a reader of the result must know."""
        self._keep(text)
        self._show(text)
        self.notes.append(text)
        self._tab.notes.append(text)

    def track(self, name: str, position: Floats, color: Color, label: str = "") -> None:
        """Show a trajectory in local east and north, with a label at its end."""
        self._keep(Track(name, position, color, label))
        if view := self._tab.tracks.add(name, position, color, label):
            self._tab.pictures.append(view)

    def map_track(self, name: str, position: Floats, color: Color) -> None:
        """Show a trajectory on a map, which the viewer fetches from the network."""
        if view := self._tab.maps.add(self.recording, name, position, color):
            self._tab.pictures.append(view)

    def scene(self, scene: Scene) -> None:
        """Show a motion over time; once on a tab, before its series."""
        self._keep(scene)
        self._tab.show(scene, self.recording, self._timelines)
        for window in windows_of(scene):
            self._timelines.window(window)

    def span(self, span: Span) -> None:
        """Shade a span of time in all charts of the tab."""
        self._keep(span)
        self._tab.spans.append(span)

    def event(self, event: Event) -> None:
        """Mark an event in all charts of the tab, and list it."""
        self._keep(event)
        self._tab.events.append(event)

    def bars(self, bars: Bars) -> None:
        """Show bars with their intervals."""
        self._keep(bars)
        self._show(bars.table())
        path = f"{self._tab.path}/bars_{len(self._tab.pictures)}"
        self._tab.pictures.append(bar_chart.draw(bars, self.recording, path))

    def summary(self, panel: Sequence[str], figure: Figure | None = None) -> None:
        """Show the lines of the panel on the first tab, beside one figure; None: the first figure of all tabs."""
        text = markdown_block(panel)
        self.recording.log("/summary/answer", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)
        views: list[rrb.View] = [rrb.TextDocumentView(origin="/summary/answer", name="Answer")]
        figure = figure or next((one.item for one in self.drawn if isinstance(one.item, Figure)), None)
        if figure is not None:
            size = (AREA[0] - PANEL, AREA[1] - TITLE_BAR)
            views.append(chart.draw(figure, self.recording, "/summary/figure", size))
        shares = (PANEL, AREA[0] - PANEL)[: len(views)]
        self._summary = rrb.Horizontal(*views, column_shares=shares, name="Summary")

    def state(self, name: str, properties: Mapping[str, Value], document: str) -> None:
        """Write the name of the recording, its properties, and the JSON of the result."""
        recorded.state(self.recording, name, properties)
        self.keep(recorded.DOCUMENT, recorded.compact(document))

    def keep(self, name: str, text: str) -> None:
        """Keep a text, which ``imuwb.review.recording.recorded`` reads."""
        recorded.keep(self.recording, name, text)

    def close(self) -> Path:
        """Write the blueprint, finish the file and return its place; the review cannot be used after this.

        Raises:
            ImuwbError: the file could not be written as a whole.
        """
        self._send_blueprint()
        self._flush()
        self._disconnect()
        if not is_whole(self._draft.path):
            reason = why_cut(self._draft.path)
            self.discard()
            raise ImuwbError(f"{self._draft.place}: cannot be written: {reason}")
        self._draft.finish()
        return self._draft.place

    def _flush(self) -> None:
        """Wait until everything is written, or nothing more is: on a full disk the thread that writes may never answer."""
        grown = -1
        while (size := self._draft.path.stat().st_size) > grown:
            grown = size
            with suppress(
                RuntimeError
            ):  # it took too long, or the thread has ended; the file shows whether all was written
                self.recording.flush(timeout_sec=PATIENCE)
                return

    def discard(self) -> None:
        """Remove the unfinished file."""
        self._disconnect()
        self._draft.discard()

    def _send_blueprint(self) -> None:
        for tab in self._tabs:
            tab.finish(self.recording, self._timelines)
        self._timelines.send(self.recording)
        layouts = [] if self._summary is None else [self._summary]
        layouts += [layout for tab in self._tabs if (layout := tab.layout(self.recording)) is not None]
        timed = (
            self._timelines.first if any(isinstance(one.item, Series | Scene | Event) for one in self.drawn) else None
        )
        first, playing = timed, SPEED if self._timelines.windows else None
        time_panel = rrb.TimePanel(state="collapsed", play_state="paused", timeline=first, playback_speed=playing)
        blueprint = rrb.Blueprint(
            rrb.Tabs(*layouts), rrb.BlueprintPanel(state="collapsed"), rrb.SelectionPanel(state="collapsed"), time_panel
        )
        self.recording.send_blueprint(blueprint)

    def _disconnect(self) -> None:
        """Let go of the file. On a full disk the viewer's library may wait for its own thread without end, and so it would at the exit."""
        leaving = threading.Thread(target=self._leave, daemon=True)
        leaving.start()
        leaving.join(LEAVING)
        if leaving.is_alive():
            rr.unregister_shutdown()

    def _leave(self) -> None:
        with suppress(RuntimeError):  # the thread that writes has ended
            self.recording.disconnect()


def _require_viewer(address: str) -> None:
    """Raise ImuwbError unless a program listens at the address; without this check the viewer's library would wait without end."""
    place = urlsplit(address)
    host, port = place.hostname or "127.0.0.1", place.port or VIEWER_PORT
    try:
        socket.create_connection((host, port), timeout=VIEWER_PATIENCE).close()
    except OSError as error:
        raise ImuwbError(
            f"--live: no viewer listens at {host}:{port}; start one with: rerun --bind 127.0.0.1"
        ) from error
