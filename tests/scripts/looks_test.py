"""How algorithms look in figures and report: each its own way, readable on light and dark."""
import json
import re
import sys
import unittest

from fixture import SOURCE, hapbench, main, must

import hapbench_looks


def contrast(first, second):
    low, high = sorted(hapbench_looks.luminance([int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]) for colour in (first, second))
    return (high + 0.05) / (low + 0.05)


class Looks(unittest.TestCase):
    LEAST_CONTRAST = 4.5  # WCAG 2.1, level AA, of text

    def test_algorithms_are_told_apart(self):
        names = {entry["name"] for entry in json.loads(hapbench("describe", "--json")) if entry["kind"] == "algorithm"}
        self.assertGreaterEqual(names, set(hapbench_looks.ALGORITHMS), "an entry for no algorithm")
        looks = [hapbench_looks.look(name) for name in names]
        for part in ("label", "colour", "dark", "marker"):
            entries = {getattr(look, part) for look in hapbench_looks.ALGORITHMS.values()}
            self.assertEqual(len(entries), len(hapbench_looks.ALGORITHMS), part)
        self.assertEqual(len({(look.colour, look.dash, look.marker) for look in looks}), len(names))

    def test_an_algorithm_without_an_entry_has_a_look_by_its_name(self):
        looks = [hapbench_looks.look(f"law_{i}") for i in range(200)]
        # The same in another process: nothing depends on the order of calls or on the seed of hashes.
        said = must(sys.executable, "-c", "import hapbench_looks; print(hapbench_looks.look('law_7'))",
                    PYTHONPATH=str(SOURCE / "scripts" / "python"), PYTHONHASHSEED="1")
        self.assertEqual(said.strip(), repr(looks[7]))
        # Of 360 hues, 4 dashes and 7 markers, 200 names share few.
        self.assertGreater(len({(look.colour, look.dash, look.marker) for look in looks}), 190)

    def test_colours_can_be_read(self):
        style = (SOURCE / "scripts/python/hapbench_report/assets/style.css").read_text(encoding="utf-8")
        light, dark = (re.findall(rf"--{name}: (#[0-9a-f]{{6}})", style) for name in ("page", "panel"))
        light, dark = [light[0], "#ffffff"], [light[1], dark[1]]
        published = hapbench_looks.Look("", hapbench_looks.PUBLISHED, hapbench_looks.PUBLISHED_DARK, (), "")
        for look in (*hapbench_looks.ALGORITHMS.values(), *hapbench_looks.SERIES, *map(hapbench_looks.look, map(str, range(400))), published):
            for colour, grounds in ((look.colour, light), (look.dark, dark)):
                for ground in grounds:
                    self.assertGreaterEqual(contrast(colour, ground), self.LEAST_CONTRAST, (look.label, colour, ground))


if __name__ == "__main__":
    main()
