"""The shared look of results: a Rerun recording, the terminal, and JSON, from the same calls.

Nothing is imported here, because tables and JSON must not wait for the viewer's library.
"""
