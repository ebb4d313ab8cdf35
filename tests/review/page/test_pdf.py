"""A page as PDF: it has all parts, and nothing is fetched for it."""

import re
import zlib
from contextlib import suppress

import pytest

from imuwb.review.page.html import printed
from imuwb.review.page.pdf import pdf


def objects(file):
    """Return the content of a PDF, unpacked."""
    parts = [file]
    for packed in re.findall(rb"stream\r?\n(.*?)\r?\nendstream", file, re.DOTALL):
        with suppress(zlib.error):
            parts.append(zlib.decompress(packed))
    return b"\n".join(parts)


@pytest.mark.slow
def test_a_page_on_paper_is_whole_and_fetches_nothing(report, server):
    pytest.importorskip("weasyprint", reason="WeasyPrint is not installed, or finds no Pango", exc_type=Exception)
    address, requests = server
    text = printed([report(), report(analysis="psd")]).replace("</body>", f'<img src="{address}/a"></body>')
    made = pdf(text)
    assert made.startswith(b"%PDF")
    content = objects(made)
    assert len(re.findall(rb"/Type ?/Page\b", content)) >= 4
    assert requests == []
