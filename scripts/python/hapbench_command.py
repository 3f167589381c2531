"""What the commands written in Python share with the program: how they refuse."""
import argparse
import sys

SUCCESS, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


def say_error(text):
    """One line on standard error, as the program writes it."""
    print(f"hapbench: error: {text}", file=sys.stderr)


class Arguments(argparse.ArgumentParser):
    """A parser whose errors are one line, without the usage before it."""

    def error(self, message):
        say_error(f"{message}; {self.prog} --help shows what there is")
        sys.exit(BAD_INPUT)
