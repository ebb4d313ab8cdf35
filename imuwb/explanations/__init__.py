"""What the terms, verdicts and faults that imuwb prints mean: paragraphs in Markdown, by name.

The ``.md`` files beside this one are the only store of these texts. A heading of the second level is a name, and its anchor in the
documentation; a line ``Also:`` after it has other names of the same thing.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from importlib.resources import files

NEAR, ALIKE = 5, 0.6  #: names that are offered for one that is not known, and how alike they must be


@dataclass(frozen=True, slots=True)
class Explanation:
    """One paragraph."""

    name: str
    also: tuple[str, ...]  #: other names
    group: str  #: title of its file
    text: str  #: Markdown, a line for each paragraph

    @property
    def anchor(self) -> str:
        """Return the anchor of the name in the documentation."""
        return anchor_of(self.name)


def anchor_of(name: str) -> str:
    """Return the anchor of a heading, as Markdown makes it: lower case, hyphens for blanks, no other signs."""
    return re.sub(r"[^\w-]", "", name.lower().replace(" ", "-"))


@cache
def explanations() -> Mapping[str, Explanation]:
    """Return all explanations by name, in the order of the files."""
    found: dict[str, Explanation] = {}
    for entry in sorted(files("imuwb.explanations").iterdir(), key=lambda entry: entry.name):
        if entry.name.endswith(".md"):
            title, *parts = re.split(r"(?m)^#{1,2} ", entry.read_text("utf-8"))[1:]
            for part in parts:
                one = _explanation(title.strip(), part)
                found[one.name] = one
    return found


def _explanation(group: str, part: str) -> Explanation:
    head, _, body = part.partition("\n")
    also = re.match(r"Also: (.*)\n", body)
    text = body[also.end() :] if also else body
    paragraphs = (" ".join(paragraph.split()) for paragraph in text.strip().split("\n\n"))
    return Explanation(head.strip(), tuple(also[1].split(", ")) if also else (), group, "\n\n".join(paragraphs))


def explanation_of(term: str) -> Explanation | None:
    """Return the explanation of a name or another name of it; case, hyphens and underscores do not matter. None: not known."""
    names = _names()
    return names.get(term.strip()) or names.get(_plain(term))


def near(term: str) -> tuple[str, ...]:
    """Return names that are like one that is not known, or that contain its words."""
    plain = _plain(term)
    names = {name: one.name for name, one in _names().items() if name == _plain(name)}
    words = {word: one for name, one in reversed(names.items()) for word in name.split()}
    inside = [one for name, one in names.items() if plain and plain in name]
    alike = [(names | words)[name] for name in get_close_matches(plain, names | words, NEAR, ALIKE)]
    return tuple(dict.fromkeys((*inside, *alike)))[:NEAR]


@cache
def _names() -> Mapping[str, Explanation]:
    """Return all names as they are written, and in plain letters; a name of its own comes before another name."""
    found: dict[str, Explanation] = {}
    for one in explanations().values():
        found.setdefault(one.name, one)
    for one in explanations().values():
        for name in (one.name, *one.also):
            found.setdefault(name, one)
            found.setdefault(_plain(name), one)
    return found


def _plain(name: str) -> str:
    return re.sub(r"[\s_-]+", " ", name.strip().lower())
