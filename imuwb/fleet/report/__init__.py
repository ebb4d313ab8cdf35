"""What the tables of a fleet say: the families of sensors, who is outside, who changes, which logs are worthless."""
