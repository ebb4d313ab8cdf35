"""Frames: what an entity of a scene shows at each time, with a number of parts that changes from time to time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from imuwb.arrays import Integers
from imuwb.review.scene.timelines import Columns, Timelines

Parts = Mapping[str, Sequence[Any]]  #: field of an archetype -> a value for each part


@dataclass(slots=True)
class Frames:
    """The frames of one entity, which are kept until they are sent."""

    archetypes: tuple[Any, ...]  #: classes of Rerun whose ``columns`` show the frames
    time: list[int] = field(default_factory=list[int])  #: ns
    parts: list[tuple[Parts, ...]] = field(
        default_factory=list[tuple[Parts, ...]]
    )  #: for each archetype; empty: nothing

    def add(self, time: int, *parts: Parts) -> None:
        """Add what is shown from a time on, by each archetype; the lists of all fields of one have one length."""
        self.time.append(int(time))
        self.parts.append(parts)

    def clear(self, time: int) -> None:
        """Show nothing from a time on."""
        self.add(time, *({} for _ in self.archetypes))

    def keep(self, timelines: Timelines, path: str, on: tuple[str, ...] | None) -> None:
        """Hand the frames over; ``on`` names the timelines that show them."""
        order = np.argsort(self.time, kind="stable")
        timelines.rows(path, np.array(self.time, dtype=np.int64)[order], self._columns(order), on)

    def _columns(self, order: Integers) -> Columns:
        def columns(rows: Integers) -> list[Any]:  # columns of Rerun
            chosen = order[rows].tolist()
            found: list[Any] = []
            for number, archetype in enumerate(self.archetypes):
                names = list(dict.fromkeys(name for parts in self.parts for name in parts[number]))
                own = [self.parts[k][number] for k in chosen]
                counts = [len(next(iter(parts.values()), ())) for parts in own]
                flat = {name: [value for parts in own for value in parts.get(name, ())] for name in names}
                found += [*archetype.columns(**flat).partition(counts)] if names else []
            return found

        return columns
