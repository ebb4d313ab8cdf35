"""Definitions of ROS 2 messages in the OMG's interface definition language, as definitions in ROS's own language.

The part of the language is that in which ROS 2 writes messages: modules, structures, typedefs, constants, annotations.

Source: https://design.ros2.org/articles/idl_interface_definition.html; ros2/rosidl, rosidl_parser.
"""

import re
from collections import ChainMap
from collections.abc import Iterator, Mapping

_WORD = re.compile(r'"(?:[^"\\]|\\.)*(?:"|\Z)|::|\w+|[{}()<>\[\];,=@#:]|[^\s\w]')
#: a text or a comment without its end goes to the end, so that no part is searched twice
_COMMENT = re.compile(
    r'("(?:[^"\\]|\\.)*(?:"|\Z))|//[^\n]*|/\*.*?(?:\*/|\Z)|^[^\S\n]*#[^\n]*', re.DOTALL | re.MULTILINE
)
_RULE = re.compile(r"^=+\s*$(?:\s*^IDL:[^\n]*$)?", re.MULTILINE)  # MCAP puts several files in one text
_NUMBERS = {
    "double": "float64", "float": "float32", "boolean": "bool", "octet": "byte", "char": "char", "string": "string",
    "wstring": "wstring", "wchar": "uint16", "short": "int16", "long": "int32", "long long": "int64", "unsigned short": "uint16",
    "unsigned long": "uint32", "unsigned long long": "uint64",
}  # fmt: skip
LONGEST = 512  #: letters of a type's name; a longer one is damage
_COMPOUND = ("unsigned", "long", "short")  #: of which the names of numbers are made up


def converted(text: str) -> dict[str, str]:
    """Return {package/Type: its fields in ROS's own language} of all structures; nothing for a text in another language."""
    text = _COMMENT.sub(lambda match: match[1] or " ", _RULE.sub(" ", text))
    words = _Words(_WORD.findall(text))
    found: dict[str, str] = {}
    try:
        _module(words, (), ChainMap(), found)
    except (IndexError, RecursionError):  # the text ends, or nests, where the language does not
        return found
    return found


class _Words:
    """The words of a text, taken one by one."""

    def __init__(self, words: list[str]) -> None:
        self._tokens, self._at = words, 0

    def peek(self) -> str:
        return self._tokens[self._at] if self._at < len(self._tokens) else ""

    def take(self) -> str:
        self._at += 1
        return self._tokens[self._at - 1]

    def skip_to(self, end: str) -> None:
        """Take all up to ``end``, with the groups in braces on the way."""
        depth = 0
        while (word := self.take()) != end or depth:
            depth += {"{": 1, "}": -1}.get(word, 0)


def _module(words: _Words, path: tuple[str, ...], typedefs: ChainMap[str, str], found: dict[str, str]) -> None:
    """Take the declarations up to the module's end, and add its structures."""
    while (word := words.peek()) and word != "}":
        words.take()
        if word == "@":
            _skip_annotation(words)
        elif word == "module":
            name = words.take()
            words.take()  # {
            _module(words, (*path, name), typedefs.new_child(), found)
            words.take()  # }
        elif word == "struct":
            name = words.take()
            words.skip_to("{")
            packages = [part for part in path if part != "msg"]
            found["/".join((*packages[-1:], name))] = "".join(f"{line}\n" for line in _fields(words, typedefs))
        elif word == "typedef":
            for line in _declared(words, typedefs):
                kind, _, name = line.rpartition(" ")
                typedefs[name] = kind
        elif word != ";":
            words.skip_to(";")


def _fields(words: _Words, typedefs: Mapping[str, str]) -> Iterator[str]:
    while words.peek() != "}":
        if words.peek() == "@":
            words.take()
            _skip_annotation(words)
        else:
            yield from _declared(words, typedefs)
    words.take()


def _skip_annotation(words: _Words) -> None:
    words.take()
    while words.peek() == "::":
        words.take()
        words.take()
    if words.peek() == "(":
        words.skip_to(")")


def _declared(words: _Words, typedefs: Mapping[str, str]) -> Iterator[str]:
    """Yield ``type name`` of each name in a declaration."""
    kind, mark = _kind(words, typedefs), ","
    while mark == ",":
        name, array = words.take(), ""
        while words.peek() == "[":
            array += "".join(words.take() for _ in range(3))
        yield f"{kind}{array} {name}"
        mark = words.take()


def _kind(words: _Words, typedefs: Mapping[str, str]) -> str:
    """Return a type in ROS's own language."""
    kind = words.take()
    if kind == "sequence":
        words.take()  # <
        inner = _kind(words, typedefs)
        bound = ""
        while (word := words.take()) != ">":
            bound += word.replace(",", "<=")
        if len(inner) + len(bound) > LONGEST:
            raise IndexError(inner[:LONGEST])
        return f"{inner}[{bound}]"
    while kind.rpartition(" ")[2] in _COMPOUND and words.peek() in (*_COMPOUND, "double"):
        kind += f" {words.take()}"
    if kind in ("string", "wstring") and words.peek() == "<":
        words.skip_to(">")
    while words.peek() == "::":
        kind += words.take() + words.take()
        if len(kind) > LONGEST:
            raise IndexError(kind[:LONGEST])
    parts = [part for part in kind.split("::") if part != "msg"]
    return typedefs.get(kind) or typedefs.get(parts[-1]) or _NUMBERS.get(kind, "/".join(parts[-2:]))
