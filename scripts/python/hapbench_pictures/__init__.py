"""Pictures of a user's own runs: `hapbench plot` and `hapbench report`."""
