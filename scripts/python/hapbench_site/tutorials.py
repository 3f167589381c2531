"""Tutorials: Markdown with cells of code, executed as a notebook, whose output goes into the page; the notebook goes beside it."""
import base64
import json
import os
import re
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from hapbench_docs.manuals import LINK, ROOT

from .pages import TUTORIALS, SiteError, contents

CELL = re.compile(r"^```\{code-cell\} (bash|python)\n((?::[^\n]*\n)*)(.*?)^```\n", re.M | re.S)
# A number in a sentence; not a part of a name, such as C5 or 2-D.
NUMBER = re.compile(r"(?<![\w.^-])\d+(?:\.\d+)?(?:e-?\d+)?(?![\w-]|\.\d)")
SHELL = "%%script bash -e\n"
CLONE = "/home/me/hapbench"  # where pages say that it all happened
PACKAGES = Path("lib/python3/dist-packages")  # below the folder of a build or an installation
SECONDS = 1500  # after which a cell counts as endless; the longest takes one minute, five on a machine that does much else


def sources():
    """The tutorials in the order in which the page of all of them names them."""
    named = LINK.findall((TUTORIALS / "README.md").read_text(encoding="utf-8"))
    return sorted((file for file in TUTORIALS.glob("*.md") if file.name != "README.md"), key=lambda file: named.index(file.name))


def from_root(text):
    """The text with links for a notebook in the root of a clone, where its commands run."""
    def moved(found):
        outside = re.match(r"^[a-z]+:|#", found[1])
        return found[0] if outside else f"]({os.path.relpath(TUTORIALS / found[1], ROOT)})"

    return LINK.sub(moved, text)


def notebook(name, text):
    """The notebook without output; cells with `:tags: [remove-cell]` check what the text says and are left out of the page."""
    from nbformat import v4

    cells, pieces = [], iter(CELL.split(text))  # text, then language, options, code, text, and so on
    for words in pieces:
        cells += [v4.new_markdown_cell(from_root(words.strip()))] if words.strip() else []
        language, options, code = (next(pieces, "") for _ in range(3))
        if language:
            tags = re.findall(r"[\w-]+", options.partition("tags:")[2])
            cells.append(v4.new_code_cell((SHELL if language == "bash" else "") + code.rstrip("\n"), metadata={"tags": tags}))
    for number, cell in enumerate(cells):
        cell["id"] = f"{name}-{number}"
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return v4.new_notebook(cells=cells, metadata={"kernelspec": kernel})


def environment(program, scratch):
    """For the kernel: this Python, the program first in the path, its Python module, and no file in anybody's home."""
    kernel = scratch / "jupyter" / "kernels" / "python3"
    kernel.mkdir(parents=True)
    (kernel / "kernel.json").write_text(json.dumps({"argv": [sys.executable, "-Xfrozen_modules=off", "-m", "ipykernel_launcher", "-f", "{connection_file}"],
                                                    "display_name": "Python 3", "language": "python"}), encoding="utf-8")
    built = program.file.parent
    if not any((built.parent / PACKAGES / "hapbench").glob("_hapbench*.so")):
        raise SiteError(f"{built.parent / PACKAGES} lacks the Python module; scripts/setup --python, then -DHAPBENCH_BUILD_PYTHON=ON, target _hapbench")
    return {**os.environ, "PATH": f"{built}:{os.environ['PATH']}", "PYTHONPATH": str(built.parent / PACKAGES),
            "HAPBENCH_PYTHON": sys.executable, "PYTHONDONTWRITEBYTECODE": "1", "HAPBENCH_PLUGIN_PATH": "", "COLUMNS": "100", "LC_ALL": "C.UTF-8",
            "JUPYTER_PATH": str(scratch / "jupyter"), "JUPYTER_RUNTIME_DIR": str(scratch / "runtime"), "IPYTHONDIR": str(scratch / "ipython")}


def executed(name, text, program):
    """The notebook with output, made in a folder that looks like a clone, in which every number of its sentences is."""
    os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # or the kernel's debugger warns of what nobody does here
    import nbclient

    book = notebook(name, text)
    with tempfile.TemporaryDirectory(prefix="hapbench-tutorial-") as scratch:
        clone = Path(scratch) / "hapbench"
        clone.mkdir()
        for folder in ("algorithms", "device_model", "scenarios", "scripts", "sim", "tests"):  # commands write to results/
            (clone / folder).symlink_to(ROOT / folder)
        (clone / "results").mkdir()
        (clone / "results" / "reference").symlink_to(ROOT / "results" / "reference")
        client = nbclient.NotebookClient(book, timeout=SECONDS, kernel_name="python3", resources={"metadata": {"path": str(clone)}})
        try:
            client.execute(env=environment(program, Path(scratch)))
        except (nbclient.exceptions.CellExecutionError, nbclient.exceptions.CellTimeoutError, nbclient.exceptions.DeadKernelError) as error:
            said = "".join(one.text for cell in book.cells for one in cell.get("outputs", ()) if one.get("name") == "stderr")
            raise SiteError(re.sub(r"\x1b\[[\d;]*m", "", f"tutorial {name}: {error}\n{said}")) from error
    for cell in book.cells:
        cell.metadata.pop("execution", None)
        for one in cell.get("outputs", ()):
            if "text" in one:  # a path of this machine means nothing to a reader
                one.text = one.text.replace(str(clone), CLONE).replace(str(ROOT), CLONE)
    lost = list(unproven_numbers(book))
    if lost:
        raise SiteError(f"tutorial {name}: no cell shows or prints {', '.join(lost)}")
    return book


def unproven_numbers(book):
    """Numbers in sentences that no cell shows or prints."""
    cells = [cell for cell in book.cells if cell.cell_type == "code"]
    seen = [cell.source for cell in cells if "remove-cell" not in cell.metadata.get("tags", ())]
    known = set(NUMBER.findall("\n".join([*seen, *map(printed, cells)])))
    for cell in book.cells:
        if cell.cell_type == "markdown":
            prose = re.sub(r"\]\([^)]*\)|`[^`]*`", "", cell.source)
            yield from (number for number in NUMBER.findall(prose) if number not in known)


def printed(cell):
    """What the cell wrote as text."""
    texts = [one["text"] if one.output_type == "stream" else one.get("data", {}).get("text/plain", "") for one in cell.get("outputs", ())
             if one.get("name") != "stderr" and "image/svg+xml" not in one.get("data", {}) and "image/png" not in one.get("data", {})]
    return "".join(texts)


def page(book, name, mirror):
    """The page of an executed notebook; its pictures are written beside it."""
    parts, pictures = [], 0
    for cell in book.cells:
        tags = cell.metadata.get("tags", ())
        if cell.cell_type == "markdown":
            parts.append(mirror.linked(cell.source, ROOT / "README.md", f"scenarios/tutorials/{name}"))
            continue
        if "remove-cell" in tags:
            continue
        shell = cell.source.startswith(SHELL)
        if "remove-input" not in tags:
            parts.append(f"````{'bash' if shell else 'python'}\n{cell.source.removeprefix(SHELL)}\n````")
        if printed(cell).strip():
            parts.append(f"````{{code-block}} text\n:class: output\n\n{printed(cell).rstrip()}\n````")
        for output in cell.outputs:
            for kind, suffix in (("image/svg+xml", "svg"), ("image/png", "png")):
                if kind in output.get("data", {}):
                    pictures += 1
                    file = f"{name}_{pictures}.{suffix}"
                    data = output["data"][kind]
                    (mirror.folder / "scenarios/tutorials" / file).write_bytes(data.encode() if suffix == "svg" else base64.b64decode(data))
                    parts.append(f"![What the commands above draw]({file})")
    return "\n\n".join(parts) + f"\n\n{{download}}`This page as a notebook <{name}.ipynb>`\n"


def add_all(mirror, program, chosen=None):
    """Pages and notebooks of all tutorials; only those chosen are executed, by default all."""
    import nbformat

    (mirror.folder / "scenarios/tutorials").mkdir(parents=True, exist_ok=True)
    texts = {file.stem: file.read_text(encoding="utf-8") for file in sources()}
    with ThreadPoolExecutor(2) as pool:
        made = {name: pool.submit(executed if chosen is None or name in chosen else lambda *given: notebook(*given[:2]), name, text, program)
                for name, text in texts.items()}
    for name in texts:
        book = made[name].result()
        mirror.add(f"scenarios/tutorials/{name}", page(book, name, mirror))
        nbformat.write(book, str(mirror.folder / f"scenarios/tutorials/{name}.ipynb"))
    readme = TUTORIALS / "README.md"
    text = mirror.linked(readme.read_text(encoding="utf-8"), readme) + "\n" + contents([f"scenarios/tutorials/{name}" for name in texts])
    mirror.add("scenarios/tutorials/index", text)
