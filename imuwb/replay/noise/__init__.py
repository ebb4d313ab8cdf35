"""The noise of the filters: added, scaled, and estimated from a drive."""
