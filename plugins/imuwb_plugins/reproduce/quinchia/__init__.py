"""Quinchia and others (2013): noise of a 3DM-GX3-25, and filters with five error models in GNSS outages."""
