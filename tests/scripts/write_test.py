"""Tests write() and write_all() of hapbench_command, with which all Python commands write their files."""
import errno
import os
import stat
import threading
import unittest
from contextlib import redirect_stderr
from io import StringIO
from pathlib import Path
from unittest import mock

from fixture import scratch_folder

from hapbench.columns import header, read_columns, read_text
from hapbench.errors import ResultError
from hapbench_command import exit_status, write, write_all


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

    def test_files_of_one_result_change_together(self):
        names = ("a", "new/b", "c")
        files = [self.root / name for name in names]
        write_all(dict.fromkeys(files, "old"))
        self.assertEqual([file.read_text() for file in files], ["old"] * 3)
        files[2].unlink()
        files[2].mkdir()
        with self.assertRaises(OSError) as caught:
            write_all(dict.fromkeys(files, "new"))
        self.assertEqual(caught.exception.filename, str(files[2]))
        self.assertEqual([file.read_text() for file in files[:2]], ["old"] * 2)
        self.assertEqual(sorted(os.listdir(self.root)), ["a", "c", "new"])
        self.assertEqual(os.listdir(files[1].parent), ["b"])

    def test_no_file_changes_if_the_disk_becomes_full(self):
        files = [self.root / name for name in "abc"]
        whole = Path.write_bytes

        def full(file, data):
            if file.name.startswith(".b"):
                whole(file, data[:1])
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(file))
            return whole(file, data)

        for old in ([], ["a", "b", "c"]):
            for name in old:
                (self.root / name).write_text("old")
            with mock.patch.object(Path, "write_bytes", full), self.assertRaises(OSError) as caught:
                write_all(dict.fromkeys(files, "new"))
            self.assertEqual(caught.exception.filename, str(files[1]))
            self.assertEqual(sorted(os.listdir(self.root)), old)
            self.assertEqual([(self.root / name).read_text() for name in old], ["old"] * len(old))

    def test_errors_name_the_cause_and_a_fix(self):
        (self.root / "a").symlink_to("b")
        (self.root / "b").symlink_to("a")
        (self.root / "file").write_text("")
        (self.root / "full").symlink_to("/dev/full")
        for name, status, text in (
            ("", 2, f"--out {self.root}: is a folder; allowed: the name of a file"),
            (
                "a",
                2,
                f"--out {self.root / 'a'}: is a link that leads in a circle; allowed: another",
            ),
            (
                "file/x",
                2,
                "x: a part of the path is a file, not a folder; allowed: a path of folders",
            ),
            ("n" * 300, 2, "the name is too long; allowed: a shorter name"),
            ("full", 1, "full: No space left on device; "),
        ):
            printed = StringIO()
            with redirect_stderr(printed):
                found = exit_status("test", "", lambda name=name: write(self.root / name, "data"))
            self.assertEqual((found, printed.getvalue().count("\n")), (status, 1), printed)
            self.assertIn(text, printed.getvalue())
            self.assertNotIn("Errno", printed.getvalue())

    def test_files_that_cannot_be_read(self):
        (self.root / "a").symlink_to("a")
        for name, text in (
            ("missing", "no such file; allowed: a file that hapbench wrote; repeat the command"),
            ("", "is a folder; allowed: a file that hapbench wrote"),
            ("a", "is a link that leads in a circle; allowed: a file that hapbench wrote"),
        ):
            for read in (read_text, header, read_columns):
                with self.assertRaises(ResultError) as caught:
                    read(self.root / name)
                self.assertTrue(str(caught.exception).startswith(f"{self.root / name}: {text}"))


if __name__ == "__main__":
    unittest.main()
