"""The scores of outages, and their statistics."""
