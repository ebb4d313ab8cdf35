"""Tables: of the streams of a log, as quantities with units, as files, and as Markdown."""
