"""Checks of a record before its noise is identified: suitable, still, stationary."""
