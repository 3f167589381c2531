"""Templates: {{name}} stands for a value, which is put in as it is."""
import re


def fill(file, values):
    # In one pass, so that a value which looks like a placeholder stays what it is.
    return re.sub(r"\{\{(\w+)\}\}", lambda match: values[match[1]], file.read_text(encoding="utf-8"))
