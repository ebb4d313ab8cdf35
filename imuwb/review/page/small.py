"""Makes matplotlib's SVG small and a part of a page: no groups without a purpose, relative paths, styles that are stated once."""

import re
from collections.abc import Iterator, Mapping, Sequence
from xml.etree import ElementTree as ET

_SVG = "{http://www.w3.org/2000/svg}"
_LINK = "{http://www.w3.org/1999/xlink}href"
_TOKEN = re.compile(r"-?[\d.]+(?:e[+-]?\d+)?")
_COMMAND = re.compile(r"([MLCQZz])([^MLCQZz]*)")
_PAIRS = {"M": 1, "L": 1, "C": 3, "Q": 2}  #: command of a path -> points after it
_PLACES = ("x", "y", "width", "height")
_STYLE = re.compile(r' style="([^"]*)"')
_REFERENCE = re.compile(r"url\(#([^)]+)\)")
_NO_PURPOSE = ("metadata", "style")
_INVISIBLE = "fill: none"  #: style of a path that shows nothing
_NO_TURN = re.compile(r"rotate\(-?0 [^)]*\)\s*")
TENTHS = 10  #: of a point: one decimal


def small(text: str, prefix: str, title: str, description: str) -> str:
    """Return the svg element of a drawing, small, with a title and a description for screen readers.

    Args:
        text: an SVG file of matplotlib.
        prefix: letters with which its ids begin, so that they are unique on a page.
        title: of the drawing.
        description: what it shows, in words.
    """
    root = ET.fromstring(text)  # noqa: S314 - matplotlib's own output
    for key in ("width", "height", "version"):
        root.attrib.pop(key, None)
    for element in root.iter():
        element.tag = element.tag.removeprefix(_SVG)
        element.tail = None
        element.text = element.text if element.text and element.text.strip() else None
        if _LINK in element.attrib:
            element.set("href", element.attrib.pop(_LINK))
    _simplify(root, {f"#{e.get('id')}": r for e in root.iter("path") if e.get("id") and (r := _radius(e.get("d", "")))})
    for element in root.iter():
        _tidy(element)
    _keep_used_ids(root, prefix)
    heading, words = ET.Element("title", id=f"{prefix}t"), ET.Element("desc", id=f"{prefix}d")
    heading.text, words.text = title, description
    root[:] = [heading, words, *root]
    root.attrib.update({"role": "img", "aria-labelledby": f"{prefix}t", "aria-describedby": f"{prefix}d"})
    return ET.tostring(root, "unicode")


def with_classes(drawings: Sequence[str]) -> tuple[str, tuple[str, ...]]:
    """Return a style sheet, and drawings whose styles are classes of it."""
    names: dict[str, str] = {}

    def name(match: re.Match[str]) -> str:
        return f' class="{names.setdefault(match[1], f"s{len(names):x}")}"'

    short = tuple(_STYLE.sub(name, drawing) for drawing in drawings)
    return "\n".join(f".{name}{{{style}}}" for style, name in names.items()), short


def _simplify(parent: ET.Element, radii: Mapping[str, float]) -> None:
    """Replace the children of an element by fewer that show the same."""
    for child in parent:
        _simplify(child, radii)
    parent[:] = list(_joined(parent, radii))


def _joined(parent: ET.Element, radii: Mapping[str, float]) -> Iterator[ET.Element]:
    """Yield the children; round markers of one style become the dots of one path."""
    dots: ET.Element | None = None
    for child in _flat(parent, radii):
        radius = radii.get(child.get("href", ""))
        if child.tag == "use" and radius:
            style = _dot_style(child, radius)
            if dots is None or dots.get("style") != style:
                dots = ET.Element("path", d="", style=style)
                yield dots
            dots.set(
                "d",
                f"{dots.get('d')} M {child.get('x', '0')} {child.get('y', '0')} L {child.get('x', '0')} {child.get('y', '0')}",
            )
            continue
        dots = None
        yield child


def _flat(parent: ET.Element, radii: Mapping[str, float]) -> Iterator[ET.Element]:
    """Yield children without those that show nothing; a group without attributes is its children."""
    for child in parent:
        if child.tag == "g" and set(child.attrib) <= {"id"}:
            yield from child
        elif not (
            child.tag in _NO_PURPOSE
            or (child.tag == "path" and (child.get("style") == _INVISIBLE or f"#{child.get('id')}" in radii))
            or (child.tag == "defs" and not len(child))
        ):
            yield child


def _tidy(element: ET.Element) -> None:
    """Shorten the attributes of an element."""
    if "d" in element.attrib:
        element.set("d", _relative(element.attrib["d"]))
    for key in _PLACES:
        if key in element.attrib:
            element.set(key, _number(element.attrib[key]))
    if "style" in element.attrib:
        parts = [part for part in element.attrib["style"].split("; ") if not part.startswith(("font-family", "font:"))]
        element.set("style", "; ".join(parts))
    if "transform" in element.attrib:
        element.set("transform", _NO_TURN.sub("", element.attrib["transform"]))
        if not element.attrib["transform"]:
            del element.attrib["transform"]


def _dot_style(use: ET.Element, radius: float) -> str:
    own = dict(part.split(": ", 1) for part in use.get("style", "").split("; ") if ": " in part)
    color = own.get("fill", own.get("stroke", "currentColor"))
    return f"fill: none; stroke: {color}; stroke-width: {_number(2 * radius)}; stroke-linecap: round"


def _radius(d: str) -> float:
    """Return the radius of a round marker about 0; 0 for a shape that is not round."""
    numbers = [abs(float(token)) for token in _TOKEN.findall(d)]
    return max(numbers) if "C" in d and numbers else 0.0


def _relative(d: str) -> str:
    """Return the data of a path with relative coordinates, rounded to tenths without drift; points that repeat are left out."""
    parts: list[str] = []
    at, last = (0, 0), ""
    for command, points in _commands(d):
        if command == "z":
            parts.append("z")
            last = ""
            continue
        letter = "M" if command == "M" else command.lower()
        if letter == last == "l" and points[0] == at:
            continue
        x, y = (0, 0) if letter == "M" else at
        numbers = [part for px, py in points for part in (_tenths(px - x), _tenths(py - y))]
        parts.append(("" if letter == last else letter) + _row(numbers, spaced=letter == last))
        at, last = points[-1], "" if letter == "M" else letter
    return "".join(parts)


def _commands(d: str) -> Iterator[tuple[str, tuple[tuple[int, int], ...]]]:
    """Yield each command of a path with its points in tenths."""
    for match in _COMMAND.finditer(d):
        command, numbers = match[1].upper(), [round(float(n) * TENTHS) for n in _TOKEN.findall(match[2])]
        if command == "Z":
            yield "z", ()
            continue
        points = tuple(zip(numbers[::2], numbers[1::2], strict=True))
        size = _PAIRS[command]
        for i in range(0, len(points), size):
            yield command, points[i : i + size]


def _row(numbers: Sequence[str], *, spaced: bool) -> str:
    """Return numbers with blanks where they are needed: before a number without a sign that follows another."""
    text = ""
    for i, number in enumerate(numbers):
        text += f" {number}" if (i or spaced) and number[0] != "-" else number
    return text


def _tenths(value: int) -> str:
    """Return tenths as a short number: -.3, 12, 4.5."""
    sign, (whole, rest) = "-" if value < 0 else "", divmod(abs(value), TENTHS)
    return f"{sign}{whole or ('' if rest else 0)}{f'.{rest}' if rest else ''}"


def _number(value: str | float) -> str:
    return _tenths(round(float(value) * TENTHS))


def _keep_used_ids(root: ET.Element, prefix: str) -> None:
    """Leave the ids that are used, and name them anew."""
    used: dict[str, str] = {}

    def name(old: str) -> str:
        return used.setdefault(old, f"{prefix}{len(used)}")

    for element in root.iter():
        for key, value in element.attrib.items():
            if key == "href":
                element.set(key, f"#{name(value[1:])}")
            else:
                element.set(key, _REFERENCE.sub(lambda match: f"url(#{name(match[1])})", value))
    for element in root.iter():
        if (old := element.attrib.pop("id", None)) in used:
            element.set("id", used[old])
