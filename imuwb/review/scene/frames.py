"""Frames: what an entity of a scene shows at each time, with a number of parts that changes from time to time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from imuwb.arrays import Integers
from imuwb.review.scene.timelines import Columns, Timelines

Parts = Mapping[str, Sequence[Any]]  #: field of the archetype -> a value for each part


@dataclass(slots=True)
class Frames:
    """The frames of one entity, which are kept until they are sent."""

    archetype: Any  #: class of Rerun whose ``columns`` shows the frames
    time: list[int] = field(default_factory=list[int])  #: ns
    parts: list[Parts] = field(default_factory=list[Parts])  #: empty: nothing is shown from this time on

    def add(self, time: int, parts: Parts) -> None:
        """Add what is shown from a time on; the lists of all fields have one length."""
        self.time.append(int(time))
        self.parts.append(parts)

    def clear(self, time: int) -> None:
        """Show nothing from a time on."""
        self.add(time, {})

    def keep(self, timelines: Timelines, path: str, on: tuple[str, ...] | None) -> None:
        """Hand the frames over; ``on`` names the timelines that show them."""
        order = np.argsort(self.time, kind="stable")
        timelines.rows(path, np.array(self.time, dtype=np.int64)[order], self._columns(order), on)

    def _columns(self, order: Integers) -> Columns:
        names = list(dict.fromkeys(name for parts in self.parts for name in parts))

        def columns(rows: Integers) -> Any:  # noqa: ANN401 - Rerun's own type
            chosen = [self.parts[k] for k in order[rows].tolist()]
            counts = [len(next(iter(parts.values()), ())) for parts in chosen]
            flat = {name: [value for parts in chosen for value in parts.get(name, ())] for name in names}
            return self.archetype.columns(**flat).partition(counts)

        return columns
