import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import SimpleNamespace

import numpy as np
import pytest

from imuwb.analysis import Answer, Curve, Figure, Mark, Series, Step, Table, Vertical
from imuwb.colors import BLUE, INK, RED, YELLOW
from imuwb.review.answers.panel import Origin
from imuwb.review.drawn.calls import Drawn, Track
from imuwb.review.page.report import report_of


def allan(points=500):
    x = np.geomspace(0.01, 1000, points)
    curve = Curve("gyro x", x, 1 / np.sqrt(x), BLUE, 0.9 / np.sqrt(x), 1.1 / np.sqrt(x))
    few = Curve("gyro y", x[:20], 2 / np.sqrt(x[:20]), YELLOW, 1.9 / np.sqrt(x[:20]), 2.1 / np.sqrt(x[:20]))
    return Figure(
        "Allan deviation", "time [s]", "deviation [deg/h]", (curve, few), (Mark(1.0, 1.0, "N x", RED),),
        verticals=(Vertical(10, "here"),),
    )  # fmt: skip


@pytest.fixture(scope="session")
def figure():
    return allan


@pytest.fixture(scope="session")
def report():
    """Return a report in which each text of a log is that text."""

    def make(text="a note", analysis="noise", name="static.csv", mark="sha256:1"):
        rng = np.random.default_rng(0)
        series = Series(
            "rate", "deg/s", np.arange(20_000) * 10**7, rng.normal(0, 1, (20_000, 2)), ("x", text), epoch="unix"
        )
        place = np.column_stack([np.linspace(0.8, 0.8001, 50), np.linspace(0.1, 0.1002, 50), np.zeros(50)])
        table = Table(
            "Noise",
            ("axis", "N"),
            ((text, "2.40 [2.38, 2.43] deg/√h"), ("gyro y", "0.20 deg/√h"), ("accel x", "9.00 m/s/√h")),
            text,
        )
        drawn = [
            Drawn("Overview", series), Drawn("Allan", allan()), Drawn("Allan", table), Drawn("Allan", text),
            Drawn("Track", Track("gnss", place, INK)), Drawn("Spectrum", allan(30)),
        ]  # fmt: skip
        rows = (("gyro x", "2.40 [2.38, 2.43]"), ("", "deg/√h"))
        answer = Answer("1 h still", ("", "N"), rows, (text,), (Step("imuwb psd {log}", "why not"),), "95 % intervals")
        log = SimpleNamespace(
            provenance=SimpleNamespace(path=f"/home/me/{name}", format="csv", hash=mark, selection="")
        )
        return report_of(
            answer, Origin(analysis, (name,), command=f"imuwb {analysis} {name}"), drawn, [log], "f00d", "1.0"
        )

    return make


@pytest.fixture
def server():
    """Return an address, and the requests that came to it."""
    requests = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            requests.append(self.path)
            self.send_response(204)
            self.end_headers()

        def log_message(self, *_):
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as listening:
        threading.Thread(target=listening.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{listening.server_port}", requests
        listening.shutdown()
