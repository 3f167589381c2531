"""Draws the figures of the thesis, and ours, from the result files of hapbench."""
