"""The documentation site: the manuals, what the program and the headers say of themselves, and executed tutorials."""
