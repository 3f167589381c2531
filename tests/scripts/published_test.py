"""The published numbers on record."""
import json
import unittest

from fixture import SOURCE, main

CLAIMS = ("T1 T2 T3 T4 R1 R2 L1 J1 G1 A1 A2 A3 A4 B1 B2 B3 C1 C2 C3 C4 F1 F2 D1 D2 D3 D4 D5 D6").split()


class PublishedNumbers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.schema = json.loads((SOURCE / "results" / "reference" / "published.schema.json").read_text(encoding="utf-8"))
        cls.file = json.loads((SOURCE / "results" / "reference" / "published.json").read_text(encoding="utf-8"))
        cls.entries = cls.file["values"]

    def test_they_agree_with_the_schema(self):
        item = self.schema["properties"]["values"]["items"]
        types = {"string": str, "number": (int, float)}
        self.assertEqual(set(self.file), set(self.schema["required"]))
        self.assertTrue(self.file["source"])
        for entry in self.entries:
            with self.subTest(entry.get("id")):
                self.assertLessEqual(set(item["required"]), set(entry))
                self.assertLessEqual(set(entry), set(item["properties"]))
                self.assertRegex(entry["id"], item["properties"]["id"]["pattern"])
                for key, value in entry.items():
                    rule = item["properties"][key]
                    self.assertIsInstance(value, types[rule["type"]])
                    self.assertGreaterEqual(len(value) if isinstance(value, str) else value,
                                            rule.get("minLength", rule.get("minimum", float("-inf"))))

    def test_each_entry_says_one_thing(self):
        for entry in self.entries:
            with self.subTest(entry["id"]):
                kinds = [bool({"mean"} & set(entry)), bool({"value"} & set(entry)), bool({"at_least", "at_most"} & set(entry)),
                         bool({"statement"} & set(entry))]
                self.assertEqual(sum(kinds), 1)
                self.assertEqual("unit" in entry, not kinds[3])
                self.assertEqual("mean" in entry, bool({"std", "standard_error"} & set(entry)))
                self.assertLessEqual(entry.get("at_least", 0), entry.get("at_most", float("inf")))

    def test_every_claim_is_there_once(self):
        names = [entry["id"] for entry in self.entries]
        self.assertEqual(len(names), len(set(names)))
        self.assertEqual({name.split(".")[0] for name in names}, set(CLAIMS))

    def test_published_statistics_agree_with_themselves(self):
        """The sign of the published t is that of the difference of the published means. Not so in Table A.2, where
        nothing differs and rounding decides (it prints equal velocities with t = 2.5)."""
        value = {entry["id"]: entry for entry in self.entries}
        for claim in ("D1", "D3", "D4"):
            for measure in ("success", "time", "force", "speed"):
                difference = (value[f"{claim}.{measure}.original_averaging"]["mean"]
                              - value[f"{claim}.{measure}.shaped_stiffness"]["mean"])
                self.assertGreater(difference * value[f"{claim}.{measure}.t"]["value"], 0, f"{claim}.{measure}")


if __name__ == "__main__":
    main()
