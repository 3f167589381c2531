"""Predictions of measured stability limits with the uncertainty of every input that was not published, and their verdicts."""
