"""The trajectories against which drift is measured, and whether they can judge."""
