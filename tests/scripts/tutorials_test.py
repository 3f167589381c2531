"""Every tutorial runs from its first cell to its last, in a folder that looks like a clone, and says no number that it does not
print; its page has the pictures of that execution, its notebook the links of a clone."""
import re
import unittest
from concurrent.futures import ThreadPoolExecutor

from fixture import PROGRAM, SOURCE, main, scratch_folder

from hapbench_docs.program import Program
from hapbench_site import tutorials
from hapbench_site.__main__ import lacking
from hapbench_site.pages import Mirror, SiteError

NAMES = {"my_mesh", "my_law", "my_device", "cluster", "thesis_claim", "contact_trace"}
CELL = "# A title\n\nIt is {} m.\n\n```{{code-cell}} bash\necho 1.25\n{}\n```\n"


def setUpModule():
    if lost := lacking():
        print(f"no {', '.join(lost)}: the tutorials are not tested (scripts/setup --site installs what runs them)")
        raise unittest.SkipTest("packages are missing")


class Tutorials(unittest.TestCase):
    def test_each_runs_and_says_what_it_prints(self):
        texts = {file.stem: file.read_text(encoding="utf-8") for file in tutorials.sources()}
        self.assertEqual(set(texts), NAMES)
        with ThreadPoolExecutor(2) as pool:
            books = {name: pool.submit(tutorials.executed, name, text, Program(PROGRAM)) for name, text in texts.items()}
        mirror = Mirror(scratch_folder(self))
        (mirror.folder / "scenarios/tutorials").mkdir(parents=True)
        for name, book in books.items():
            with self.subTest(name):
                page = tutorials.page(book.result(), name, mirror)
                pictures = re.findall(r"!\[[^]]*\]\((\S+)\)", page)
                self.assertGreater(len(pictures), 0)
                for picture in pictures:
                    self.assertIn("<svg" if picture.endswith("svg") else "PNG",
                                  (mirror.folder / "scenarios/tutorials" / picture).read_bytes().decode("latin-1"))
                self.assertIn("What next", page)
                self.assertNotIn("assert metrics", page)

    def test_its_notebook_leads_from_the_root_of_a_clone(self):
        for file in tutorials.sources():
            book = tutorials.notebook(file.stem, file.read_text(encoding="utf-8"))
            for cell in book.cells:
                for link in tutorials.LINK.findall(cell.source) if cell.cell_type == "markdown" else ():
                    self.assertTrue((SOURCE / link.partition("#")[0]).exists(), f"{file.name}: {link}")

    def run_cell(self, number, command="true"):
        return tutorials.executed("small", CELL.format(number, command), Program(PROGRAM))

    def test_a_number_that_nothing_prints_is_found(self):
        self.assertEqual(tutorials.printed(self.run_cell("1.25").cells[1]), "1.25\n")
        with self.assertRaisesRegex(SiteError, "small: no cell shows or prints 1.26"):
            self.run_cell("1.26")

    def test_without_the_python_module_it_says_what_to_do(self):
        folder = scratch_folder(self)
        (folder / "bin").mkdir()
        (folder / "bin" / "hapbench").write_text("", encoding="utf-8")
        with self.assertRaisesRegex(SiteError, "lacks the Python module; scripts/setup --python"):
            tutorials.environment(Program(folder / "bin" / "hapbench"), folder)

    def test_a_cell_that_fails_is_found_with_what_it_said(self):
        with self.assertRaisesRegex(SiteError, "nothing is called"):
            self.run_cell("1.25", "hapbench describe nosuch\necho on")


if __name__ == "__main__":
    main()
