"""The `stereo-pick` command and its subcommands."""
