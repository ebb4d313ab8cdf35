"""The analyses and conditioners that come with imuwb, one folder each, registered like those of other packages."""
