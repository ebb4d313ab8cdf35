"""A motion in the viewer: its timelines, the body, tracks, plan, and what is shaded in charts."""
