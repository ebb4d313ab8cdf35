"""Functions that write topics and read their streams."""

import pytest

from imuwb.readers import ReadOptions, read

from .db3_writer import write_db3
from .ros_values import encoded
from .shape_truth import COUNT, T


@pytest.fixture
def imus_of(mcap):
    def imus(*topics, **options):
        return read(mcap.write(*topics), ReadOptions(**options)).imus

    return imus


@pytest.fixture
def log_of(fresh):
    """Return a function that reads messages of some topics without definitions: {topic: (type, values of message i)}."""

    def made(topics, step=10**7, form=0):
        rows = {
            topic: (kind, [(T + i * step, encoded(kind, values(i, T + i * step), form)) for i in range(COUNT)])
            for topic, (kind, values) in topics.items()
        }
        return read(write_db3(fresh("log.db3"), rows))

    return made
