"""The shared look of results: a Rerun recording, the terminal, and JSON, from the same calls."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from imuwb.review.document import document
    from imuwb.review.overview import overview
    from imuwb.review.recording import RecordingReview
    from imuwb.review.tables import streams_table

__all__ = ["RecordingReview", "document", "overview", "streams_table"]

_HOMES = {"document": "document", "overview": "overview", "RecordingReview": "recording", "streams_table": "tables"}


def __getattr__(name: str) -> object:
    """Import what is asked for: tables and JSON need no viewer."""
    if name in _HOMES:
        return getattr(import_module(f"imuwb.review.{_HOMES[name]}"), name)
    message = f"module 'imuwb.review' has no attribute {name!r}"
    raise AttributeError(message)
