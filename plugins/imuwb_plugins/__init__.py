"""The analyses and conditioners that come with imuwb, one folder each, registered as a stranger's would be."""
