"""What a record is like before its noise is identified: suitable, still, the same throughout."""
