"""The start of the filters: where the heading comes from."""
