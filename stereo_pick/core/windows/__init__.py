"""Windows: patches of the left view found again in the right one, for method `ssd`, and planes that many lie on."""
