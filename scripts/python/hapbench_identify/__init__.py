"""Identifies a device from its log, and designs the signal to play: the work behind `hapbench identify`."""
