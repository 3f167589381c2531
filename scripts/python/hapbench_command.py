"""Functions that all commands written in Python share: error messages, suggestions of valid names, writing of files,
and a notice during long work."""
import argparse
import atexit
import difflib
import errno
import json
import math
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
import time
import traceback
from contextlib import contextmanager, suppress
from pathlib import Path

from hapbench.errors import InputError

# Help text of an option that has the same meaning in every command.
SHARED = 'shared options; "hapbench --help" explains them'
SUCCESS, FAILED, BAD_INPUT, DIFFERENT, INTERRUPTED = 0, 1, 2, 3, 130
MAX_FAULTS = 20  # largest number of faults in one error message
SILENCE = 2.0  # time before the first notice about the elapsed time [s]
SCHEMA = Path(__file__).resolve().parents[2] / "scenarios" / "library" / "scenario.schema.json"

_unfinished = set()  # temporary files of write_all(), which Ctrl-C removes
_written = []  # files that write_all() has completed


def print_error(text):
    """Prints an error as one line on standard error, in the form of the program's errors. Control characters, for
    example in file names, are replaced by "?"."""
    line = "".join("?" if c < " " or c == "\x7f" else c for c in str(text))
    print(f"hapbench: error: {line}", file=sys.stderr)


def print_warning(text):
    """Prints a warning as one line on standard error, in the form of the program's warnings."""
    line = "".join("?" if c < " " or c == "\x7f" else c for c in str(text))
    print(f"hapbench: warning: {line}", file=sys.stderr)


class Arguments(argparse.ArgumentParser):
    """An argument parser that prints an error as one line, without the usage."""

    def error(self, message):
        print_error(f"{message}; {self.prog} --help shows the usage")
        sys.exit(BAD_INPUT)


class CommandLine(Arguments):
    """Parser of the arguments after the name of a command. Its help and errors have the form of the commands written in
    C++. `notes`: paragraphs below the options. `examples`: command lines. `manual`: page and section of the manual.
    """

    def __init__(self, name, summary, notes, examples, manual):
        super().__init__(
            prog=f"hapbench {name}",
            description=summary,
            add_help=False,
            allow_abbrev=False,
        )
        self.name = name
        self.notes, self.examples, self.manual = notes, examples, manual
        self.add_argument("-h", "--help", action="help", help=SHARED)

    def text(self, name, metavar, meaning, **more):
        """Adds an option with one value. `metavar`: placeholder of the value in the help, such as "<file>"."""
        self.add_argument(name, metavar=metavar, help=meaning, **more)

    def texts(self, name, metavar, meaning):
        """Adds an option whose argument is a list of values, separated by commas."""
        self.text(
            name,
            metavar,
            meaning,
            action="extend",
            default=[],
            type=lambda text: [part.strip() for part in text.split(",") if part.strip()],
        )

    def one_of(self, names, name, metavar, meaning):
        def checked(word):
            if word in names:
                return word
            quoted = ", ".join(f'"{known}"' for known in names)
            raise argparse.ArgumentTypeError(
                f'got "{word}"; allowed: {quoted}{nearest(word, names)}'
            )

        self.text(name, metavar, meaning, type=checked)

    def flag(self, name, meaning):
        self.add_argument(name, action="store_true", help=meaning)

    def add_output_options(self):
        for name in ("--json", "--quiet", "--wide"):
            self.flag(name, SHARED)

    def parse(self, words):
        """Returns the parsed arguments. The word after an option that takes a value is this value, even if the word
        begins with "-". Positional arguments, which are files or folders, may stand before, between and after options.
        After "--", all words are positional arguments."""
        options = words[: words.index("--")] if "--" in words else words
        if not {"-h", "--help"}.isdisjoint(options):
            self.print_help()
            self.exit()
        with_value = {
            name for action in self._actions if action.nargs != 0 for name in action.option_strings
        }
        joined = []
        for word in words:
            if joined and joined[-1] in with_value and "--" not in joined:
                joined[-1] += f"={word}"
            else:
                joined.append(word)
        if "--" in joined:
            # argparse takes a file whose name begins with "-" for an option, even after "--".
            at = joined.index("--")
            joined[at:] = [
                f"./{word}" if word.startswith("-") else word for word in joined[at + 1 :]
            ]
        return self.parse_intermixed_args(joined)

    def error(self, message):
        subject, _, rest = message.partition(": ")
        word = rest.split(" ")[0].partition("=")[0]
        if subject == "the following arguments are required":
            message = f"{rest} is required"
        elif subject == "unrecognized arguments" and word.startswith("-"):
            names = [name for action in self._actions for name in action.option_strings]
            message = f'unknown option "{word}"{nearest(word, names)}'
        elif subject == "unrecognized arguments":
            message = f'unexpected argument "{word}"'
        print_error(
            f'{self.name}: {message.removeprefix("argument ")}; "{self.prog} --help" explains'
        )
        sys.exit(BAD_INPUT)

    def format_help(self):
        width = min(shutil.get_terminal_size((100, 24)).columns, 100)
        usage, parts = f"Usage: {self.prog} [OPTIONS]", []
        for title, named in (("Arguments:", False), ("Options:", True)):
            actions = [action for action in self._actions if bool(action.option_strings) == named]
            shared = ", ".join(
                action.option_strings[-1] for action in actions if action.help == SHARED
            )
            parts += ["", title] if actions else []
            for action in actions:
                if action.help == SHARED:
                    continue
                word = word_of(action)
                if not named:
                    usage += f" {word}" if action.required else f" [{word}]"
                parts.append(entry(word, action.help, width))
            if shared and named:
                parts.append(entry(shared, SHARED, width))
        lines = [textwrap.fill(self.description, width, **WHOLE_WORDS), "", usage, *parts]
        for note in self.notes:
            lines += ["", textwrap.fill(note, width, **WHOLE_WORDS)]
        lines += ["", "Examples:", *(f"  {example}" for example in self.examples)]
        lines += ["", textwrap.fill(f"Manual: {self.manual}", width, **WHOLE_WORDS)]
        return "\n".join(lines) + "\n"


WHOLE_WORDS = {"break_long_words": False, "break_on_hyphens": False}


def word_of(action):
    """Returns the name of an option with its placeholder, or the placeholder of a positional argument, as the help
    prints them."""
    if action.option_strings:
        value = f" {action.metavar}" if action.nargs != 0 else ""
        return ",".join(action.option_strings) + value
    return action.metavar + ("..." if action.nargs in ("+", "*") else "")


def entry(word, meaning, width):
    """Returns lines of the help: a word, and its meaning on the right of the word. If the word is too long, its meaning
    begins on the next line. `width`: largest length of a line."""
    column = 28
    text = textwrap.fill(
        meaning, width, initial_indent=" " * column, subsequent_indent=" " * column, **WHOLE_WORDS
    )
    return f"  {word}\n{text}" if len(word) + 4 > column else f"  {word}{text[len(word) + 2:]}"


def the_program():
    """Returns the path of the program hapbench: the program that started this process, or, if the program did not start
    this process, the program in PATH. Returns None if the program is also not in PATH."""
    return os.environ.get("HAPBENCH_PROGRAM") or shutil.which("hapbench")


def output_of_program(what, *words):
    """Returns the text that the program prints for the arguments `words`. Raises InputError if the program is not found
    or fails; if it fails, the error has its messages. `what`: what the program does, for the message that the program
    is not found, such as "evaluates --where".
    """
    program = the_program()
    if not program:
        fail(f"the program hapbench, which {what}, is not in the path")
    done = subprocess.run(
        [program, *map(str, words)],
        capture_output=True,
        encoding="utf-8",
        errors="surrogateescape",
        stdin=subprocess.DEVNULL,
    )
    if done.returncode:
        lines = done.stderr.strip().splitlines() or [f"{program}: exit status {done.returncode}"]
        raise Faults([("", line.removeprefix("hapbench: error: ")) for line in lines])
    return done.stdout


def stop_on_ctrl_c(name):
    """Makes Ctrl-C end this process with status 130 and a message of one line. Any other uncaught exception ends this
    process with a message of one line instead of a traceback.

    The __main__ of a command calls this function before it imports large modules such as numpy. The program starts
    Python with Ctrl-C blocked; this function unblocks it. The handler ends the process itself, because a
    KeyboardInterrupt can be lost in a callback or a destructor, and prints a traceback during an import.
    """

    def stop(*_):
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        for scratch in list(_unfinished):
            with suppress(OSError):
                os.unlink(scratch)
        # On a terminal, this text erases the line that notice() has written.
        end_of_line = "\r\033[K" if sys.stderr.isatty() else ""
        with suppress(OSError):
            os.write(2, f"{end_of_line}hapbench: {name} {stopped()}\n".encode())
        _end(INTERRUPTED)

    def fail_in_one_line(kind, error, trace):
        if isinstance(error, OSError):
            unwritable(error)
        else:
            print_error(error if isinstance(error, InputError) else internal_error(name, error))

    sys.excepthook = fail_in_one_line
    # A shell starts background jobs with Ctrl-C ignored. Ctrl-C remains ignored in such a job.
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, stop)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def stopped():
    return f"stopped; {written()}"


def written():
    return f"written: {', '.join(_written)}" if _written else "nothing was written"


def leave(status):
    """Ends this process with an exit status. The interpreter does not finalize its modules, because Ctrl-C during the
    finalization would print a traceback or be lost."""
    with suppress(OSError, ValueError):
        sys.stderr.flush()
    _end(status)


def _end(status):
    """Calls the functions that are registered with atexit, because matplotlib removes a folder by such a function. Then
    ends the process."""
    with suppress(BaseException):
        atexit._run_exitfuncs()
    os._exit(status)


def internal_error(name, error):
    """Returns a message of one line about an unexpected exception, with the source line that raised it."""
    frames = traceback.extract_tb(error.__traceback__)
    location = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
    if isinstance(error, MemoryError):
        return f"{name}: not enough memory{location}"
    text = str(error) or "no message"
    return f"{name}: internal error: {type(error).__name__}: {text}{location}"


def exit_status(name, doing, work):
    """Calls `work`, which does the work of the command `name`, and returns the exit status of the command. `doing`:
    text of the notice during long work; empty for no notice. Each fault of a rejected input is printed as one line. Any
    other failure is printed as one line."""
    try:
        with notice(doing):
            status = work()
        sys.stdout.flush()
        return status or SUCCESS
    except InputError as error:
        for fault in getattr(error, "lines", [error]):
            print_error(fault)
        return BAD_INPUT
    except BrokenPipeError:
        # The reader of the pipe, such as `head`, has closed the pipe.
        sys.stderr.close()
        return SUCCESS
    except OSError as error:
        return unwritable(error)
    except KeyboardInterrupt:
        print(f"hapbench: {name} {stopped()}", file=sys.stderr)
        return INTERRUPTED
    except Exception as error:
        print_error(internal_error(name, error))
        return FAILED


def answer(options, text, data):
    """Prints the warnings of a command on standard error, then its result on standard output: the text, or with --json
    the JSON. With --quiet, the result is not printed."""
    for warning in data["warnings"] if isinstance(data, dict) else []:
        print(f"hapbench: warning: {warning}", file=sys.stderr)
    if not options.quiet:
        print(json.dumps(data, indent=2, ensure_ascii=False) if options.json else text)


def file_word(file):
    """Returns a file name as a word of a command line. A name that begins with "-" is prefixed with "./", so that it is
    not read as an option."""
    name = str(file)
    return f"./{name}" if name.startswith("-") else name


def shell_line(*words):
    return " ".join(map(shlex.quote, map(str, words)))


def table_text(headings, rows, wide, numbers=False):
    """Returns a table as text. If `wide` is false and the terminal is too narrow, the last column is wrapped.
    `numbers`: true aligns all columns except the first to the right."""
    widths = [max(map(len, column)) for column in zip(headings, *rows)]
    if sys.stdout.isatty() and not wide:
        widths[-1] = min(
            widths[-1],
            max(24, shutil.get_terminal_size().columns - sum(widths[:-1]) - 2 * len(widths[:-1])),
        )
    lines = [headings, ["-" * width for width in widths]]
    for *cells, last in rows:
        first, *more = textwrap.wrap(last, widths[-1]) or [""]
        lines += [[*cells, first]] + [[""] * len(cells) + [part] for part in more]
    return "".join(
        "  ".join(
            cell.rjust(width) if numbers and i else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(line, widths))
        ).rstrip()
        + "\n"
        for line in lines
    )


def nearest(name, names):
    """Returns the end of an error message about an unknown name: a text with the most similar valid name, worded as in
    the program's messages. Returns an empty text if no name is similar."""
    lower = {candidate.lower(): candidate for candidate in reversed(names)}
    # Prefers names that begin with the given name, then names that contain it, then names that are only similar.
    longer = sorted((n for n in lower if n.startswith(name.lower())), key=len) or [
        n for n in lower if name.lower() in n
    ]
    close = longer or difflib.get_close_matches(name.lower(), lower, 1)
    return f'; nearest valid name: "{lower[close[0]]}"' if close else ""


class Faults(InputError):
    """An error with several faults. `list`: (location, problem) of each fault."""

    def __init__(self, faults):
        super().__init__(faults)
        self.list = faults

    @property
    def lines(self):
        lines = [
            f"{location}: {problem}" if location else problem for location, problem in self.list
        ]
        return lines + (
            [f"no more than {MAX_FAULTS} are shown"] if len(lines) == MAX_FAULTS else []
        )


def fail(problem, location=""):
    raise Faults([(location, problem)])


def require_name(got, name, valid):
    if name not in valid:
        names = ", ".join(f'"{v}"' for v in valid)
        fail(f'{got} "{name}"; allowed: {names}{nearest(name, valid)}')


def finite_number(word):
    """Returns the number that `word` (bytes) is, or NaN if `word` is not a finite number. Unlike for float(), "1_0" and
    " 1" are not numbers."""
    value = (
        float(word) if re.fullmatch(rb"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", word) else math.nan
    )
    return value if math.isfinite(value) else math.nan


def unique_keys(pairs):
    """Returns the members of a JSON object as a dict. Fails if a key is repeated. A function for object_pairs_hook of
    json.load."""
    found = {}
    for key, value in pairs:
        if key in found:
            fail(f"the key {quoted(key)} stands twice in one object; allowed: once")
        found[key] = value
    return found


def shown(value):
    """Returns a JSON value as text for a message: one line of at most about 80 characters."""
    text = json.dumps(value, separators=(",", ":")).replace("\x7f", "\\u007f")
    return text if len(text) <= 80 else text[:80] + "..."


def quoted(word):
    """Quotes a word (bytes or text) for a message."""
    data = word if isinstance(word, bytes) else word.encode("utf-8", "surrogateescape")
    return shown(data[:60].decode("utf-8", "replace"))


def plain(number):
    return repr(float(number)).removesuffix(".0")


def refuse_source(out, source, what):
    """Raises an error if the output file is the input file."""
    if os.path.exists(out) and os.path.exists(source) and os.path.samefile(out, source):
        fail(f"--out {out}: is the {what} itself; allowed: another file")


def is_stream(file):
    """Returns True for a pipe, a device, and a link to one of them."""
    return file.exists() and not file.is_file() and not file.is_dir()


def write(file, data):
    """Creates or replaces a file atomically. `data`: text or bytes. If the file is a link, its target is created or
    replaced. A pipe or a device is not replaced; the data are written into it. If this fails, raises OSError with the
    name of the file."""
    write_all({file: data})


def write_all(contents):
    """Creates or replaces the files of one result. `contents`: dict from each file to its data, as for write(). The
    data of all files are first written to temporary files, which are renamed at the end. If one file cannot be written,
    no file changes, so that no folder holds a mixture of old and new files."""
    renamed = []  # (file, temporary file, file that the temporary file replaces)
    try:
        for file, data in contents.items():
            with named_in_errors(file):
                file.parent.mkdir(parents=True, exist_ok=True)
                if is_stream(file):
                    continue
                target = _target_of(file) if file.is_symlink() else file
                if target.is_dir():
                    raise OSError(errno.EISDIR, os.strerror(errno.EISDIR))
                scratch = target.with_name(f".{target.name}.{os.getpid()}.tmp")
                _unfinished.add(scratch)
                renamed.append((file, scratch, target))
                scratch.write_bytes(_bytes_of(data))
        for file in filter(is_stream, contents):
            with named_in_errors(file), file.open("wb") as stream:
                stream.write(_bytes_of(contents[file]))
            _written.append(str(file))
        for file, scratch, target in renamed:
            with named_in_errors(file):
                scratch.replace(target)
            _written.append(str(file))
    finally:
        for _, scratch, _ in renamed:
            scratch.unlink(missing_ok=True)
            _unfinished.discard(scratch)


def _bytes_of(data):
    return data if isinstance(data, bytes) else data.encode()


@contextmanager
def named_in_errors(file):
    """Makes an OSError in the `with` statement, which writes `file`, name this file and not a temporary file or a
    folder."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(file)) from error


# Cause and fix of errors that occur when a file is written.
WHY_UNWRITABLE = {
    errno.EISDIR: "is a folder; allowed: the name of a file",
    errno.EEXIST: "a part of the path is a file, not a folder; allowed: a path of folders",
    errno.ENOTDIR: "a part of the path is a file, not a folder; allowed: a path of folders",
    errno.ENOENT: "cannot be created there; allowed: a folder on a disk",
    errno.ELOOP: "is a link that leads in a circle; allowed: another name",
    errno.ENAMETOOLONG: "the name is too long; allowed: a shorter name",
    errno.EACCES: "no permission to write there; allowed: a folder in which you may write",
    errno.EPERM: "no permission to write there; allowed: a folder in which you may write",
    errno.EROFS: "the disk is read-only; allowed: a folder in which you may write",
}


def _target_of(link):
    """Returns the file to which a link, or a chain of links, leads. Raises OSError for links that form a cycle."""
    target = Path(os.path.realpath(link))
    if target.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
    return target


def unwritable(error):
    """Prints why a file or standard output could not be written and returns the exit status. The status is FAILED
    if the disk is full or broken, or if standard output cannot be written. Otherwise the path of the file is wrong, and
    the status is BAD_INPUT."""
    if error.filename is None:
        with suppress(OSError, ValueError):
            # Discards the remaining output, which cannot be printed.
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        print_error(f"cannot write to standard output: {error.strerror or error}")
        return FAILED
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EIO):
        print_error(
            f"cannot write {error.filename}: {error.strerror}; {written()}; free some space, or name a folder on "
            "another disk with --out"
        )
        return FAILED
    cause = WHY_UNWRITABLE.get(error.errno, f"{error.strerror}; allowed: another name")
    print_error(f"--out {error.filename}: {cause}")
    return BAD_INPUT


@contextmanager
def notice(text):
    """If the work in the `with` statement takes longer than SILENCE, prints `text` and the elapsed seconds on standard
    error. On a terminal, one line is updated; otherwise a line is printed after 2, 4, 8 s and so on. Prints nothing if
    `text` is empty."""
    ended = threading.Event()
    thread = threading.Thread(target=show_seconds, args=(text, ended), daemon=True)
    if text:
        thread.start()
    try:
        yield
    finally:
        ended.set()
        if text:
            thread.join()


def show_seconds(text, ended):
    start, terminal = time.monotonic(), sys.stderr.isatty()
    pause = SILENCE
    while not ended.wait(pause):
        seconds = time.monotonic() - start
        line = f"hapbench: {text} ... {seconds:.0f} s"
        print(
            f"\r{line}\033[K" if terminal else line,
            end="" if terminal else "\n",
            file=sys.stderr,
            flush=True,
        )
        pause = 0.5 if terminal else seconds
    if terminal and pause != SILENCE:
        print("\r\033[K", end="", file=sys.stderr, flush=True)
