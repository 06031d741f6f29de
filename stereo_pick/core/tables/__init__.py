"""The table that the objects stand on: what shows where it is, and what it says of each of them."""
