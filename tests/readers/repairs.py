"""What readers repaired, by the ids of the notes."""


def repairs(stream):
    """Return {id: count} of a stream's repairs."""
    return {repair.what.id: repair.count for repair in stream.origin.repairs}
