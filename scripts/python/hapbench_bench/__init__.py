"""scripts/bench: measures ratios, tells what is met, and compares two commits."""
