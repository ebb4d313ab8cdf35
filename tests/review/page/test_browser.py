"""The page in a real browser: it complains about nothing, asks for nothing, and its tables are sorted by value and unit."""

import re
import shutil
import subprocess

import pytest

from imuwb.review.page.html import page

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
#: what a reader does, as a script at the end of the page
DEEDS = """
const heading = document.querySelectorAll(".table th button")[1];
heading.click();
const column = table => [...table.tBodies[0].rows].map(row => row.cells[1].textContent).join("|");
const table = heading.closest("table"), shown = [column(table), heading.parentElement.ariaSort];
heading.click(); shown.push(column(table), heading.parentElement.ariaSort);
heading.click(); shown.push(column(table), heading.parentElement.ariaSort);
document.querySelector("button.copy").click();
shown.push(document.querySelectorAll("details[open]").length);
dispatchEvent(new Event("beforeprint")); shown.push(document.querySelectorAll("details:not([open])").length);
dispatchEvent(new Event("afterprint")); shown.push(document.querySelectorAll("details[open]").length);
document.body.dataset.shown = JSON.stringify(shown);
"""


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium on this machine")
def test_a_browser_shows_it_sorts_its_tables_opens_them_for_print_and_asks_for_nothing(tmp_path, report, server):
    address, requests = server
    hostile = f'"><img src="{address}/a"><script src="{address}/b"></script><style>@import "{address}/c";</style>'
    text = page([report(hostile)]).replace("</body>", f'<script>{DEEDS}</script><img src="{address}/d"></body>')
    (tmp_path / "page.html").write_text(text, "utf-8")
    done = subprocess.run(
        [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run",
         f"--user-data-dir={tmp_path / 'profile'}", "--enable-logging=stderr", "--dump-dom", f"file://{tmp_path}/page.html"],
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    complaints = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    assert len(complaints) == 1  # the page's own rule refuses the image that this test has put in
    assert f"{address}/d" in complaints[0]
    assert "Content Security Policy" in complaints[0]
    assert requests == []
    assert "2.40 [2.38, 2.43]" in done.stdout
    shown = re.search(r'data-shown="([^"]*)"', done.stdout)[1].replace("&quot;", '"')
    up, down, given = (
        "0.20 deg/√h|2.40 [2.38, 2.43] deg/√h|9.00 m/s/√h", "9.00 m/s/√h|2.40 [2.38, 2.43] deg/√h|0.20 deg/√h",
        "2.40 [2.38, 2.43] deg/√h|0.20 deg/√h|9.00 m/s/√h",
    )  # fmt: skip
    assert shown == f'["{up}","ascending","{down}","descending","{given}",null,0,0,0]'
