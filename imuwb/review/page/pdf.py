"""A page as PDF, through WeasyPrint."""

import logging
from typing import Any

from imuwb.errors import UsageError

REMEDY = 'install it with: pip install "imuwb[pdf]"; or write the page with --html, open it in a browser, and print it to a file'


def check_pdf() -> None:
    """Raise UsageError unless PDF can be written here."""
    _library()


def pdf(html: str) -> bytes:
    """Return a page for paper as PDF; nothing is fetched.

    Args:
        html: that ``imuwb.review.page.html.printed`` made.
    """
    logging.getLogger("weasyprint").setLevel(
        logging.ERROR
    )  # it states each rule of the style sheet that is for screens
    logging.getLogger("fontTools").setLevel(logging.ERROR)
    library = _library()
    nothing = library.urls.URLFetcher(allowed_protocols=())  # a page has no links to other files
    return library.HTML(string=html, url_fetcher=nothing).write_pdf()


def _library() -> Any:  # noqa: ANN401 - it has no types
    try:
        import weasyprint  # pyright: ignore[reportMissingImports] # noqa: PLC0415 - an extra
    except ImportError as error:
        raise UsageError(f"--pdf needs WeasyPrint, which is not installed; {REMEDY}") from error
    except OSError as error:  # it finds no Pango
        raise UsageError(f"--pdf: WeasyPrint does not find a library that it needs: {error}; {REMEDY}") from error
    return weasyprint
