"""Items made ahead come in order, errors where they belong, and nothing is made of what nobody wants."""

import threading

import pytest

from imuwb.readers.bytes.ahead import ahead


def test_items_come_in_order_from_another_thread():
    threads = set()

    def items():
        for i in range(50):
            threads.add(threading.get_ident())
            yield i

    assert list(ahead(items(), 3)) == list(range(50))
    assert threads.isdisjoint({threading.get_ident()})


def test_an_error_is_raised_where_its_item_would_be():
    def items():
        yield 1
        yield 2
        yield int("third")

    coming = ahead(items(), 4)
    assert [next(coming), next(coming)] == [1, 2]
    with pytest.raises(ValueError, match="third"):
        next(coming)


def test_only_so_many_are_made_ahead_and_the_rest_not_at_all():
    made = []

    def items():
        for i in range(100):
            made.append(i)
            yield i

    coming = ahead(items(), 2)
    for _ in range(5):
        next(coming)
    coming.close()
    assert len(made) <= 5 + 2
