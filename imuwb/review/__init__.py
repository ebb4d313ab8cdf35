"""Shows results as a Rerun recording, in the terminal, and as JSON; the same calls make all three.

Nothing is imported here, so that tables and JSON do not wait for the import of the viewer's library.
"""
