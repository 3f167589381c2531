"""The C++ interface as its headers declare and comment it, and the Python interface by its docstrings."""
import ast
import re
from collections import defaultdict

from hapbench_docs.manuals import ROOT

from .pages import contents
from .reference import entry, literal, plain

FOLDERS = ("sim", "algorithms", "device_model", "results", "scenarios")
NAME = re.compile(r"\b(?:struct|class|union|enum class|enum|using|namespace)\s+(\w+)|([\w~]+|operator\S+)\s*(?=\()|(\w+)\s*(?==|\{|;|\[)")
OVERVIEW = re.compile(r"((?:^///[^\n]*\n)+)(?=namespace )", re.M)
PRIVATE = re.compile(r"^ (?:private|protected):\n.*?(?=^ public:\n|^\};)", re.M | re.S)


def comment(text):
    """The words of a comment as Markdown."""
    return in_line(re.sub(r"^/// ?", "", text, flags=re.M))


def declared(text):
    """(comment, declaration) of what stands at the margin, where clang-format puts what a namespace declares."""
    about, code = "", ""
    lines = text.splitlines(keepends=True)
    for line, following in zip(lines, [*lines[1:], ""]):
        if code or re.match(r"(?!namespace )\w" if about else r"(struct|class|enum)\b[^;]*\{", line):
            code += line
            bare = re.sub(r"//.*|\"[^\"\n]*\"|'.'", "", code)
            closed = sum(map(bare.count, "([{")) == sum(map(bare.count, ")]}")) and re.search(r"[;}]\s*$", bare)
            # What follows at once has the same comment.
            if closed and not re.match(r"(?!namespace )\w", following):
                yield about, code
                about, code = "", ""
        else:
            about = about + line if line.startswith("///") else ""


def declaration(text):
    """What is declared: of a class its public part, of a function no body."""
    if re.match(r"(template <.*\n)?(struct|class|union|enum)\b", text):
        return PRIVATE.sub("", text)
    return re.split(r"\s*(?<!=)\s\{\n|\s\{ ", text, maxsplit=1)[0].rstrip("\n;") + ";"


def of_header(header, known):
    """A header's part of its folder's page; names in `known` have an entry already."""
    text = (ROOT / header).read_text(encoding="utf-8")
    overview = OVERVIEW.search(text)
    if header.endswith(".h"):  # in C, with comments of its own
        return f"## {header.rpartition('/')[2]}\n\n{literal(text, 'c')}"
    parts = [f"## {header.rpartition('/')[2]}\n\n`#include \"{header}\"`\n", comment(overview[1]) if overview else ""]
    for about, code in declared(text):
        shown = declaration(code)
        name = next(filter(None, NAME.search(re.sub(r"^template <.*?>\n", "", shown)).groups()))
        parts.append(entry("cpp-name", name, *((":noindex:",) if name in known else ()), comment(about), literal(shown, "cpp")))
        known.add(name)
    return "\n".join(parts)


def add_cpp(mirror):
    folders, known = defaultdict(list), set()
    for file in sorted(file for folder in FOLDERS for suffix in ("hpp", "h") for file in (ROOT / folder).rglob(f"*.{suffix}")):
        header = str(file.relative_to(ROOT))
        folders[header.rpartition("/")[0]].append(of_header(header, known))
    for folder, parts in folders.items():
        mirror.add(f"reference/cpp/{folder}", f"# C++: {folder}\n\n" + "\n".join(parts))
    mirror.add("reference/cpp", "# C++\n\nThe public headers by folder, as they declare and comment it. [As a library](../tests/index.md#hapbench-as-a-library) "
               "says how a project of its own uses them.\n\n" + contents((f"reference/cpp/{folder}" for folder in sorted(folders)), hidden=False))


def stub(node, inside=False):
    """A definition without bodies and what is private; what is inside a class keeps its docstring."""
    if isinstance(node, ast.AnnAssign):
        return node
    public = [one for one in node.body if isinstance(one, ast.AnnAssign) or isinstance(one, ast.FunctionDef) and (one.name == "__init__" or one.name[0] != "_")]
    about = node.body[:1] if inside and ast.get_docstring(node) else []
    inner = [stub(one, True) for one in public] if isinstance(node, ast.ClassDef) else []
    node.body = [*about, *inner] or [ast.Expr(ast.Constant(...))]
    return node


def add_python(mirror):
    """What `hapbench.__all__` names, as its module defines it; the package need not be built for that."""
    trees = {file.stem: ast.parse(file.read_text(encoding="utf-8")) for file in (ROOT / "scripts" / "python" / "hapbench").glob("*.py")}
    nodes = {node.name: node for tree in trees.values() for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    parts = ["# Python\n\n`import hapbench`, by its docstrings. [The manual](../scripts/python/index.md) shows it at work.\n"]
    for name in ast.literal_eval(next(node for node in trees["__init__"].body if isinstance(node, ast.Assign)).value):
        about = docstring(ast.get_docstring(nodes[name]) or "")
        parts += [f"## {name}\n", entry("python-name", f"hapbench.{name}", about, literal(ast.unparse(stub(nodes[name])), "python"))]
    mirror.add("reference/python", "\n".join(parts))


def docstring(text):
    """Indented parts are code, and so is what stands in backticks."""
    parts = re.split(r"((?:^(?: {4}.*)?\n?)+)", text, flags=re.M)
    return "".join(f"\n{literal(part.strip(chr(10)), 'python')}\n" if part.startswith("    ") else in_line(part) for part in parts)


def in_line(text):
    return "".join(part if part.startswith("`") else plain(part) for part in re.split(r"(`[^`\n]+`)", text))
