"""From files to bytes to arrays: opening, unpacking, and picking numbers out of buffers."""
