"""From the pieces that readers yield to the streams of a Log."""
