"""The likelihood of a record in cosines, and the sums of processes that it prefers."""
