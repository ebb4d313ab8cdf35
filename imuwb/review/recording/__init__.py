"""The recording that the viewer opens: its tabs, its name and properties, and whether its file is whole."""
