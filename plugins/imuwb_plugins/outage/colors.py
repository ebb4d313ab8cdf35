"""One colour per filter, in every figure and track."""

from __future__ import annotations

COLORS = {
    "none": (150, 150, 158), "15AV": (76, 120, 168), "18AV": (84, 162, 75), "18AVWD": (228, 87, 86), "15AR": (242, 142, 43),
    "27AR": (176, 122, 161), "full": (118, 183, 178), "tuned": (237, 201, 72),
}  # fmt: skip
OTHER = (255, 157, 167)
REFERENCE = (225, 225, 228)
PALETTE = (
    (228, 87, 86), (76, 120, 168), (84, 162, 75), (242, 142, 43), (176, 122, 161), (118, 183, 178), (237, 201, 72),
)  # fmt: skip


def color_of(name: str) -> tuple[int, int, int]:
    """Return a filter's colour."""
    return COLORS.get(name, OTHER)
