import pytest

from imuwb.readers.bytes.bisection import bracket


@pytest.mark.parametrize("time", [-5, 0, 1, 4_999, 70_000, 99_999, 200_000])
@pytest.mark.parametrize("fine", [1, 64])
def test_a_time_lies_between_two_near_places(time, fine):
    size, looked = 100_000, []

    def time_at(place):
        looked.append(place)
        return place

    low, high = bracket({place: place for place in range(0, size, 25_000)}, time_at, time, size, fine)
    assert 0 <= low <= high <= size
    assert high - low <= fine
    assert low == 0 or low < time
    assert high == size or high >= time
    assert len(looked) <= 16  # halves of 25,000 bytes
