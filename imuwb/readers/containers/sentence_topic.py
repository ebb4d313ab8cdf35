"""Topics of NMEA sentences (``nmea_msgs/Sentence``): the fixes of a receiver in text."""

from collections.abc import Iterator
from dataclasses import replace

from imuwb.arrays import Integers
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.containers.decoders import Decoder
from imuwb.readers.containers.messages import Messages

FIELD = "sentence"  #: of the message
TYPE = "nmea_msgs/Sentence"


class SentenceTopic:
    """The sentences of one topic; their dates are known at the end only."""

    def __init__(self) -> None:
        """No sentence is taken yet."""
        from imuwb.readers.receivers.nmea_sentences import Sentences  # noqa: PLC0415 - few recordings have sentences

        self._sentences, self._offset = Sentences(), 0

    def take(self, decoder: Decoder, messages: Messages, rows: Integers) -> None:
        """Keep the sentences of some messages."""
        text = b"".join(line.strip(b"\r\n\0") + b"\r\n" for line in decoder.texts(messages, rows, FIELD))
        self._sentences.take(text, self._offset, last=True)
        self._offset += len(text)

    def fixes(self, name: str, bytes_read: int) -> Iterator[Batch | Remark]:
        """Yield the fixes, named as the topic, and notes."""
        from imuwb.readers.receivers.nmea_streams import streamed  # noqa: PLC0415 - as above

        for part in streamed(self._sentences, bytes_read):
            if isinstance(part, Batch) or part.stream:
                yield replace(part, stream=name)
            else:
                yield part
