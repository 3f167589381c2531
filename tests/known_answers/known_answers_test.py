"""Every printed field has a known answer: tests/known_answers/README.md."""
import unittest

import of_batches  # noqa: F401  (registers scenes)
import of_ends  # noqa: F401
import of_energy  # noqa: F401
import of_forces  # noqa: F401
import of_limits  # noqa: F401
import of_places  # noqa: F401
import of_convergence  # noqa: F401
import of_runs  # noqa: F401
import of_slow_contacts  # noqa: F401
from answers import SCENES, Answer, Bench, Within
from fields import open_fields, printed_fields
from fixture import main, scratch_folder

FOUND = {}


def benches(folder):
    """Each scene's bench, once."""
    for name, work in SCENES.items():
        if name not in FOUND:
            FOUND[name] = Bench(name, folder / name)
            work(FOUND[name])
    return FOUND


def answers():
    return [answer for bench in benches(scratch_folder(unittest)).values() for answer in bench.answers]


class KnownAnswers(unittest.TestCase):
    def test_what_is_printed_is_known_and_no_naive_answer(self):
        for answer in answers():
            with self.subTest(field=answer.field, scene=answer.scene):
                self.assertEqual(list(answer.faults()), [])

    def test_every_field_has_one_that_a_naive_answer_fails(self):
        fields = printed_fields(benches(scratch_folder(unittest)).values())
        lacking = open_fields(fields, answers())
        self.assertEqual(lacking, [], "a printed field without a row in a scene of tests/known_answers")

    def test_rows_are_of_printed_fields(self):
        fields = set(printed_fields(benches(scratch_folder(unittest)).values()))
        self.assertEqual(sorted({answer.field for answer in answers()} - fields), [])

    def test_columns_of_files_are_described(self):
        fields = {field for field in printed_fields(benches(scratch_folder(unittest)).values()) if ":" in field}
        for bench in FOUND.values():
            for file in bench.folder.rglob("*.csv"):
                name = file.name
                header = file.read_text(encoding="utf-8").split("\n")[0].split(",")
                if f"{name}:{header[0]}" in fields and f"{name}:metrics" not in fields:
                    varied = {column for column in header if "." in column and name == "limit_runs.csv"}
                    self.assertEqual({f"{name}:{column}" for column in set(header) - varied} - fields, set())

    def test_a_wrong_number_is_found(self):
        within = Within("", relative=1e-6)
        wrong = Answer("x", "y", "", within, 1.0, 1.0 + 1e-5, ("", 1.0 + 1e-7))
        self.assertEqual(len(list(wrong.faults())), 2)
        self.assertEqual(list(Answer("x", "y", "", within, 1.0, 1.0 + 1e-7, ("", 1.1)).faults()), [])
        self.assertEqual(len(list(Answer("x", "y", "", within, "stable", "vibrating").faults())), 1)
        self.assertEqual(len(list(Answer("x", "y", "", within, 1.0, None).faults())), 1)


if __name__ == "__main__":
    main()
