"""The site: every manual, field, metric, algorithm and command is on it and found by its search, and its links lead somewhere."""
import json
import re
import unittest
import unittest.mock

from fixture import PROGRAM, SOURCE, hapbench, main, must, scratch_folder

from hapbench_docs.manuals import manuals
from hapbench_site.__main__ import lacking, make
from hapbench_site.links import broken
from hapbench_site.pages import SiteError, page_of

LACKING = ", ".join(lacking())


def setUpModule():
    if LACKING:
        print(f"no {LACKING}: the site is not tested (scripts/setup --site installs what it is built with)")
        raise unittest.SkipTest("packages are missing")
    global SITE
    SITE = scratch_folder(unittest) / "site" / "html"
    # Tutorials have a test of their own, which executes them.
    must(SOURCE / "scripts/python/launch", "hapbench_site", "--program", PROGRAM, "--out", SITE.parent, "--tutorials")


def text_of(page):
    """The page's words, without the markup."""
    html = (SITE / f"{page}.html").read_text(encoding="utf-8")
    return re.sub(r"<[^>]+>", "", html)


class Index:
    """The search index that the pages load."""

    def __init__(self):
        from sphinx.search import SearchEnglish, js_index

        self._index = js_index.loads((SITE / "searchindex.js").read_text(encoding="utf-8"))
        self._stem = SearchEnglish({}).stem

    def pages(self, words):
        """Pages that have all words, in the text or the title."""
        found = [self._of(self._stem(word.lower())) for word in words.split()]
        return {self._index["docnames"][number] for number in set.intersection(*found)}

    def _of(self, stem):
        numbers = (self._index[part].get(stem, ()) for part in ("terms", "titleterms"))
        return {number for given in numbers for number in (given if isinstance(given, (list, tuple)) else (given,))}

    def things(self, kind):
        """Names of the kind that the search knows, such as fields."""
        kinds = {number: names[1] for number, names in self._index["objnames"].items()}
        return {f"{prefix}.{entry[4]}" if prefix else entry[4] for prefix, entries in self._index["objects"].items()
                for entry in entries if kinds[str(entry[1])] == kind}


class Site(unittest.TestCase):
    def test_every_manual_is_on_it(self):
        for file in manuals():
            self.assertTrue((SITE / f"{page_of(file)}.html").is_file(), file)

    def test_every_link_leads_somewhere(self):
        self.assertEqual(list(broken(SITE)), [])
        self.assertGreater(len(list(SITE.rglob("*.html"))), 80)

    def test_a_broken_link_is_found(self):
        site = scratch_folder(self)
        (site / "a.html").write_text('<p id="here"><a href="a.html#here"><a href="b.html"><a href="#there"><img src="c.svg"><a href="https://x.y/z">', encoding="utf-8")
        self.assertEqual([link for _, link in broken(site)], ["b.html", "#there", "c.svg"])

    def test_the_search_finds_pages_by_their_words(self):
        index = Index()
        self.assertIn("algorithms/index", index.pages("stiffness shaping"))
        self.assertIn("scenarios/TUNING", index.pages("symptom buzz"))
        self.assertIn("results/reference/claims", index.pages("verdicts claims"))
        self.assertEqual(index.pages("stiffness nosuchword"), set())

    def test_every_thing_of_the_program_is_on_it(self):
        index = Index()
        listed = json.loads(hapbench("list", "--json"))
        self.assertEqual(index.things("algorithm"), {one["name"] for one in listed if one["kind"] == "algorithm"})
        self.assertEqual(index.things("scenario"), {one["name"] for one in listed if one["kind"] == "scenario"})
        metrics = {one["name"] for one in json.loads(hapbench("describe", "metrics", "--json"))[0]["metrics"]}
        self.assertEqual(index.things("metric"), metrics)
        commands = set(re.findall(r"^  ([a-z]+) +[A-Z]", hapbench("--help").split("\nCommands:\n")[1], re.M))
        self.assertEqual(index.things("command"), {f"hapbench {name}" for name in commands})
        # As the program prints them: names of fields stand alone on their line.
        fields = set(re.findall(r"^  (\S+)$", hapbench("describe", "scenario").split("\nscenario\n")[1], re.M))
        self.assertGreater(len(fields), 80)
        self.assertEqual(fields - index.things("field"), set())
        self.assertIn("hand.direction", index.things("field"))

    def test_interfaces_are_on_it(self):
        self.assertIn("class Simulation", text_of("reference/cpp/sim/loop"))
        self.assertIn("force_law", text_of("reference/python"))

    def test_live_page(self):
        self.assertIn("live", text_of("live").lower())

    def test_without_its_packages_it_says_what_to_do(self):
        with unittest.mock.patch("importlib.util.find_spec", lambda name: None if name == "furo" else name):
            self.assertEqual(lacking(), ["furo"])
            with self.assertRaisesRegex(SiteError, "furo; scripts/setup --site"):
                make(None)


if __name__ == "__main__":
    main()
