"""Makes the streams of a Log from the pieces that readers yield."""
