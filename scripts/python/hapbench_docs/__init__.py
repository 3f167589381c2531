"""What is generated in the manuals, and what the manuals promise."""
