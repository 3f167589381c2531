"""Makes strokes to play back from recordings: the work behind `hapbench import`."""
