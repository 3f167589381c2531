"""The command line of scripts/site."""
import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

from hapbench_command import BAD_INPUT, FAILED, INTERRUPTED, SUCCESS, Arguments, say_error
from hapbench_docs.manuals import ROOT
from hapbench_docs.program import Program, ProgramError

from . import api, links, tutorials
from .pages import Mirror, SiteError
from .reference import Reference

DESCRIPTION = """Builds the documentation site, OUT/html/index.html, which needs no server: the manuals; commands, fields, metrics
and algorithms as the program describes them; the C++ and Python interface from their comments; the tutorials, executed here, as
pages and notebooks; the live page if it is built. Every link is checked. Needs the built program with its Python
module; installs what is missing (scripts/setup --site). Exit status 1 if something of it does not hold."""
LIVE = ROOT / "build" / "live" / "live.html"


def arguments(words):
    parser = Arguments(prog="scripts/site", description=DESCRIPTION)
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "bin" / "hapbench", metavar="FILE",
                        help="default: build/release/bin/hapbench")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "site", metavar="FOLDER", help="default: build/site")
    parser.add_argument("--tutorials", nargs="*", metavar="NAME", help="execute these alone; the others are shown without results")
    return parser.parse_args(words)


def built(html, mirror, program):
    """Sphinx on the mirror; no warning is let pass."""
    version = program.run(["--version"], ".").split()[1]
    folder = Path(__file__).parent
    done = subprocess.run([sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "-j", "2", "-c", folder,
                           "-d", mirror.folder.parent / "doctrees", mirror.folder, html],
                          capture_output=True, text=True, env={**os.environ, "HAPBENCH_SITE_VERSION": version})
    if done.returncode:
        raise SiteError("sphinx:\n" + "\n".join(dict.fromkeys(done.stderr.strip().splitlines())))


def add_whole_pages(html, mirror):
    """Pages that are whole as they are: the live page if there is one."""
    text = "Scenes that run in the browser, with the program's own step: move the tool and feel the numbers change.\n\n"
    if LIVE.is_file():
        (html / "whole").mkdir(parents=True, exist_ok=True)
        shutil.copyfile(LIVE, html / "whole" / "live.html")
        text += '<p><a href="whole/live.html">The live page</a></p>\n'
    else:
        text += "It was not built when this site was made: `scripts/live` writes it to `build/live/live.html`, then `scripts/site` brings it here.\n"
    mirror.add("live", f"# Live\n\n{text}")


def lacking():
    """What is not installed of what the site is built with."""
    return [name for name in ("sphinx", "myst_parser", "furo", "nbclient", "ipykernel") if importlib.util.find_spec(name) is None]


def make(chosen):
    if lost := lacking():
        raise SiteError(f"{sys.executable} lacks {', '.join(lost)}; scripts/setup --site installs what the site is built with")
    program = Program(chosen.program)
    out = chosen.out.resolve()
    html = out / "html"
    for part in ("source", "doctrees", "html"):
        shutil.rmtree(out / part, ignore_errors=True)
    mirror = Mirror(out / "source")
    mirror.folder.mkdir(parents=True)
    mirror.add_manuals()
    Reference(program, mirror).add_all()
    api.add_cpp(mirror)
    api.add_python(mirror)
    tutorials.add_all(mirror, program, chosen.tutorials)
    add_whole_pages(html, mirror)
    built(html, mirror, program)
    lost = [f"{page}: {link}" for page, link in links.broken(html)]
    if lost:
        raise SiteError("broken links:\n" + "\n".join(lost))
    print(f"built {html / 'index.html'}")


def main(words=None):
    try:
        make(arguments(words))
    except (ProgramError, OSError) as error:
        say_error(error)
        return BAD_INPUT
    except SiteError as error:
        say_error(error)
        return FAILED
    except KeyboardInterrupt:
        return INTERRUPTED
    return SUCCESS


if __name__ == "__main__":
    sys.exit(main())
