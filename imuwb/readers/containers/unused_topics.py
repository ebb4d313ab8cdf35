"""What a recording has that is not used: topics by their types, in a line for each reason."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from imuwb.readers.batch import Remark, unused
from imuwb.texts import counted, names_text

NO_QUANTITY = "no quantity that imuwb reads"
MOST_NAMES = 12  #: topics of a type that are named; the others are counted
MOST_TYPES = 24  #: types in a line; the others are counted


@dataclass(frozen=True, slots=True)
class Unused:
    """A topic that is not used."""

    topic: str
    schema: str  #: type of its messages; empty if it has no schema
    messages: int
    why: str


def unused_topics(topics: Iterable[Unused]) -> Iterator[Remark]:
    """Yield a remark for each reason, which names the topics by the types of their messages."""
    reasons: dict[str, dict[str, list[Unused]]] = defaultdict(lambda: defaultdict(list))
    for topic in topics:
        reasons[topic.why][topic.schema].append(topic)
    for why, types in reasons.items():
        texts = [_of_a_type(schema, group) for schema, group in list(types.items())[:MOST_TYPES]]
        rest = [topic for group in list(types.values())[MOST_TYPES:] for topic in group]
        if rest:
            texts.append(f"{counted(len(rest), 'topic')} of {counted(len(types) - MOST_TYPES, 'other type')}")
        yield unused(texts, why)


def _of_a_type(schema: str, topics: list[Unused]) -> str:
    """Return the topics of one type, with the number of their messages."""
    names = names_text([topic.topic for topic in topics], MOST_NAMES)
    count = sum(topic.messages for topic in topics)
    return f"{names}: {counted(count, 'message')} of {schema or 'no schema'}"
