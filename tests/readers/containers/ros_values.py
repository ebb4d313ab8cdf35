"""Messages of ROS 2 on the wire from their definitions and the values of some fields; all other fields are 0 or empty."""

import struct

from imuwb.readers.containers import ros_layout
from imuwb.ros import definitions

CODES = {"f8": "d", "f4": "f"} | {f"{'i' if s else 'u'}{n}": c if s else c.upper() for s in (0, 1) for n, c in ((1, "b"), (2, "h"), (4, "i"), (8, "q"))}  # fmt: skip


def encoded(kind, values, form=0):
    """Return a message of a type that is known; ``values``: {path: number, text, or tuple of an array}."""
    steps, whole = ros_layout.whole_plan(kind, list(definitions(kind))[form])
    assert whole
    assert values.keys() <= {step.path for step in steps}, values.keys() - {step.path for step in steps}
    body = bytearray()

    def put(code, *numbers):
        for number in numbers:
            body.extend(bytes(-len(body) % struct.calcsize(code)))
            body.extend(struct.pack(f"<{code}", number))

    for step in steps:
        value = values.get(step.path)
        if isinstance(step, ros_layout.Jump):
            text = (value or "").encode() + b"\0" if step.size == 1 else b""
            put("I", len(text))
            body.extend(text)
        elif step.count:
            put(CODES[step.kind], *(value or (0,) * step.count))
        else:
            put(CODES[step.kind], value or 0)
    return b"\0\1\0\0" + bytes(body)


def stamped(time, **values):
    """Return the values of a header at a time (ns), and others; ``__`` in a name stands for a dot."""
    named = {name.replace("__", "."): value for name, value in values.items()}
    return {
        "header.stamp.sec": time // 10**9,
        "header.stamp.nanosec": time % 10**9,
        "header.frame_id": "sensor",
        **named,
    }
