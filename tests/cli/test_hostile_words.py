"""The words of a log are data: escapes, Markdown, HTML and odd letters in names do nothing in any output, whatever the command."""

import json
import re
import socket
import sys
import threading
import unicodedata
from pathlib import Path
from typing import Self

import pytest

from tests.conftest import Topic, imu_message, write_mcap

T = 1_714_564_800 * 10**9
ROWS = 400
ESCAPES = "/imu\x1b]52;c;aGVsbG8=\x07\x1b[1A\x1b[2K"
MARKDOWN = "/a\n\n# HEAD\n|x|y|\n|-|-|\n![p](http://127.0.0.1:{port}/p.png)[l](file:///etc/passwd)<http://127.0.0.1:{port}/>```\n"
HTML = '/b"><img src=http://127.0.0.1:{port}/q.png><script>fetch("http://127.0.0.1:{port}/")</script>'
TURNED = "/c\u202egpj.exe\u200b\ufeff\u2066"
LONG = "/d" + "x" * 30_000
#: what may make an output do something else than show letters
HIDDEN = {"Cc", "Cf", "Zl", "Zp"}
LINKS = re.compile(r"(?<!\\)\]\(|(?<!\\)!\[|(?<!\\)<http")


def hostile(folder: Path, port: int = 9) -> Path:
    """Write a log with such names of topics, frames and types, in a file with such a name."""
    names = [name.replace("{port}", str(port)) for name in (ESCAPES, MARKDOWN, HTML, TURNED, LONG)]
    topics = []
    for i, name in enumerate(names):
        rows = [
            (
                t := T + k * 10**7,
                imu_message(t, (0.001 * (k % 7), 0.002 * (k % 5), i), (0.1 * (k % 3), 0.2, 9.8), name[:200]),
            )
            for k in range(ROWS if i < 2 else 20)
        ]
        topics.append(Topic(rows, topic=name))
    file = "a\x1b[2J\u202e![p](http:).mcap" if sys.platform != "win32" else "a.mcap"
    topics.append(Topic([(T, b"\0\1\0\0")], topic=f"{names[0]}/odd", schema=f"x{names[1]}/Y", definition="string s\n"))
    return write_mcap(folder / file, *topics)


def check(text: str, where: str) -> None:
    """Check that a text has no letter that is not shown."""
    odd = {c for c in text if unicodedata.category(c) in HIDDEN and c not in "\n\t"}
    assert not odd, f"{where}: {odd!r}"


def documents(recording: Path) -> dict[str, str]:
    """Return the texts that a recording shows as Markdown, and check its entity paths."""
    from rerun.chunk import RrdReader

    found = {}
    for chunk in RrdReader(str(recording)).stream():
        check(str(chunk.entity_path), "entity path")
        batch = chunk.to_record_batch()
        for i, name in enumerate(batch.schema.names):
            if name.endswith("TextDocument:text"):
                found[str(chunk.entity_path)] = batch.column(i).to_pylist()[0][0]
    return found


def live_markdown(text: str) -> bool:
    """Return whether a text as Markdown has a link, a picture or a heading of a log."""
    rest = re.sub(r"(?ms)^(`{3,})text\n.*?^\1$", "", text)  # a block that shows letters as they are
    return bool(LINKS.search(rest) or re.search(r"(?m)^#+ HEAD", rest))


@pytest.mark.slow
def test_no_command_passes_on_what_a_log_writes(imuwb, tmp_path):
    log = hostile(tmp_path)
    commands = {
        "info": ("info", log),
        "info as JSON": ("info", log, "--json"),
        "health": ("health", log, "-o", "h.rrd", "--json", "h.json", "--html", "h.html", "--full"),
        "psd": ("psd", log, "--imu", "/imu", "-o", "p.rrd"),  # no such name: all names are listed
        "convert to MCAP": ("convert", log, "-o", "c.mcap"),
        "convert to CSV": ("convert", log, "-o", "c.csv"),
        "report": ("report", "h.rrd", "-o", "r.html"),
        "catalog": ("catalog", "."),
        "view": ("view", log),
        "no analysis": (f"x{ESCAPES}",),
    }
    for name, command in commands.items():
        done = imuwb(*command)
        check(done.out, f"{name}, stdout")
        check(done.err, f"{name}, stderr")
    assert json.loads((tmp_path / "h.json").read_text("utf-8"))
    for file in tmp_path.iterdir():
        if file == log:
            continue
        check(file.name, "name of a file")
        if file.suffix in (".json", ".html", ".toml", ".csv"):
            check(file.read_text("utf-8"), file.name)
    for page in ("h.html", "r.html", "index.html"):
        text = (tmp_path / page).read_text("utf-8")
        assert "<img src=http" not in text, page
        assert "<script>fetch" not in text, page
    shown = documents(tmp_path / "h.rrd")
    assert any("HEAD" in text for text in shown.values())
    for place, text in shown.items():
        check(text, place)
        assert not live_markdown(text), place
    again = imuwb("info", "c.mcap")
    assert again.code == 0
    check(again.out, "what was converted")


class Witness:
    """A server on this machine that answers nothing and counts who connects."""

    def __enter__(self) -> Self:
        self.seen = 0
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port = self._server.getsockname()[1]
        self._thread = threading.Thread(target=self._count, daemon=True)
        self._thread.start()
        return self

    def _count(self):
        while True:
            try:
                connection, _ = self._server.accept()
            except OSError:
                return
            self.seen += 1
            connection.close()

    def __exit__(self, *_: object) -> None:
        self._server.close()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the viewer without a window is tried on Linux")
def test_the_viewer_that_shows_such_a_log_asks_for_nothing(imuwb, tmp_path, monkeypatch):
    experimental = pytest.importorskip("rerun.experimental", reason="this viewer cannot be driven")
    import rerun_cli

    monkeypatch.setenv("CI", "true")
    with Witness() as witness:
        with socket.create_connection(("127.0.0.1", witness.port)):
            pass  # the witness sees
        imuwb("health", hostile(tmp_path, witness.port), "-o", "h.rrd")
        try:
            viewer = experimental.ViewerClient.spawn(
                headless=True,
                hide_welcome_screen=True,
                executable_path=str(Path(rerun_cli.__file__).with_name("rerun")),
            )
        except Exception as error:  # noqa: BLE001 - no driver for graphics
            pytest.skip(f"the viewer does not start here: {error}")
        try:
            viewer.open(str(tmp_path / "h.rrd"))
            _show_all_tabs(viewer)
        finally:
            viewer.quit()
        assert witness.seen == 1


def _show_all_tabs(viewer):
    """Draw each tab."""
    import time

    time.sleep(1.0)
    blueprint = viewer.get_blueprint(of="recording").blueprint
    containers = {k: v["ContainerBlueprint"] for k, v in blueprint.items() if "ContainerBlueprint" in v}
    tabs = [c for c in containers.values() if c.get("container_kind") == "Tabs" and "active_tab" in c]
    assert tabs
    for container in tabs:
        for tab in container["contents"]:
            container["active_tab"] = tab
            viewer.set_blueprint(blueprint, of="recording")
            assert viewer.take_screenshot(max_size=400)
            time.sleep(0.3)
            viewer.take_screenshot(max_size=400)
