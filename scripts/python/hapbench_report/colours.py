"""The algorithms' colours as custom properties of the page: var(--algorithm-mean), and var(--published)."""
from hapbench_looks import ALGORITHMS, PUBLISHED, PUBLISHED_DARK


def colour_rules():
    light = properties((name, look.colour) for name, look in ALGORITHMS.items()) + f"--published:{PUBLISHED};"
    dark = properties((name, look.dark) for name, look in ALGORITHMS.items()) + f"--published:{PUBLISHED_DARK};"
    # As in style.css: on screen only, because paper is white.
    return (f":root{{{light}}}\n@media screen and (prefers-color-scheme:dark){{:root:not([data-theme=light]){{{dark}}}}}\n"
            f"@media screen{{:root[data-theme=dark]{{{dark}}}}}\n")


def properties(colours):
    return "".join(f"--algorithm-{name.replace('_', '-')}:{colour};" for name, colour in colours)


def algorithm_name(algorithm, shown):
    """Ready HTML of a name in the algorithm's colour."""
    if algorithm not in ALGORITHMS:
        return shown
    return f'<span style="color:var(--algorithm-{algorithm.replace("_", "-")})">{shown}</span>'
