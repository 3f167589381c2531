"""Tests write() of hapbench_command, with which all Python commands write their files."""
import os
import stat
import threading
import unittest
from pathlib import Path

from fixture import scratch_folder

from hapbench_command import write


class Write(unittest.TestCase):
    def setUp(self):
        self.root = scratch_folder(self)

    def test_a_file_is_created_and_replaced(self):
        file = self.root / "new" / "file"
        for text in ("first", "second"):
            write(file, text)
            self.assertEqual(file.read_text(), text)
        self.assertEqual(os.listdir(file.parent), ["file"])

    def test_a_link_stays_and_its_target_is_replaced(self):
        folder = self.root / "folder"
        folder.mkdir()
        (folder / "old").write_text("old")
        for target in ("old", "missing"):
            link = self.root / f"link_{target}"
            link.symlink_to(folder / target)
            write(link, b"new")
            self.assertTrue(link.is_symlink())
            self.assertEqual((folder / target).read_text(), "new")
        self.assertEqual(sorted(os.listdir(folder)), ["missing", "old"])

    def test_a_pipe_stays_and_gets_the_data(self):
        pipe, link = self.root / "pipe", self.root / "link"
        os.mkfifo(pipe)
        link.symlink_to(pipe)
        for file in (pipe, link):
            read = []
            reader = threading.Thread(target=lambda: read.append(Path(pipe).read_bytes()))
            reader.start()
            write(file, "data")
            reader.join(timeout=10)
            self.assertEqual(read, [b"data"])
            self.assertTrue(stat.S_ISFIFO(pipe.stat().st_mode))
        self.assertTrue(link.is_symlink())
        self.assertEqual(sorted(os.listdir(self.root)), ["link", "pipe"])

    def test_a_folder_and_a_cycle_of_links_are_refused(self):
        (self.root / "a").symlink_to("b")
        (self.root / "b").symlink_to("a")
        for file in (self.root, self.root / "a"):
            with self.assertRaises(OSError) as caught:
                write(file, "data")
            self.assertEqual(caught.exception.filename, str(file))
        self.assertEqual(sorted(os.listdir(self.root)), ["a", "b"])


if __name__ == "__main__":
    unittest.main()
