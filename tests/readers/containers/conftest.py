"""A function that writes topics as MCAP and reads their IMUs."""

import pytest

from imuwb.readers import ReadOptions, read


@pytest.fixture
def imus_of(mcap):
    def imus(*topics, **options):
        return read(mcap.write(*topics), ReadOptions(**options)).imus

    return imus
