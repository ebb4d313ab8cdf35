"""Allan variances, their moments, and the sum of processes that explains them."""
