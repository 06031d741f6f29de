"""The nodes, one file each; `main` is its executable."""
