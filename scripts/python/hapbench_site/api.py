"""The C++ interface by the comments of the public headers, which Doxygen reads, and the Python interface by its docstrings."""
import ast
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from collections import defaultdict

from hapbench_docs.manuals import ROOT

from .pages import contents
from .reference import entry, literal, plain

FOLDERS = ("sim", "algorithms", "device_model", "results", "scenarios")
SETTINGS = """QUIET = YES
RECURSIVE = YES
FILE_PATTERNS = *.hpp *.h
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
WARN_IF_UNDOCUMENTED = NO
JAVADOC_AUTOBRIEF = YES
"""
# The comment of a header as a whole stands before its first namespace.
OVERVIEW = re.compile(r"((?:^///[^\n]*\n)+)(?=namespace )", re.M)


class ApiError(Exception):
    """Doxygen complains of a comment."""


def markdown(node):
    """A description of Doxygen's XML: paragraphs, code and lists."""
    if node is None:
        return ""
    text = plain(node.text or "")
    for child in node:
        inner = markdown(child)
        if child.tag == "computeroutput":
            inner = f"`{''.join(child.itertext())}`"
        elif child.tag == "para":
            inner = f"{inner.strip()}\n\n"
        elif child.tag == "listitem":
            inner = f"- {inner.strip()}\n"
        elif child.tag in ("itemizedlist", "orderedlist"):
            inner = f"\n\n{inner}\n"
        elif child.tag in ("verbatim", "programlisting", "preformatted"):
            inner = f"\n\n{literal(''.join(child.itertext()))}\n"
        text += inner + plain(child.tail or "")
    return text


def said(node):
    """Brief and detailed description together."""
    return "\n\n".join(filter(None, (markdown(node.find(f"{part}description")).strip() for part in ("brief", "detailed"))))


def words(node, tag):
    found = node.find(tag)
    return "" if found is None else re.sub(r"\s+", " ", "".join(found.itertext())).strip()


def declaration(member):
    """A member as its header declares it, without the body."""
    kind, name = member.get("kind"), words(member, "name")
    template = ", ".join(" ".join(filter(None, (words(p, "type"), words(p, "declname")))) for p in member.findall("templateparamlist/param"))
    head = f"template <{template}> " if template else ""
    if kind == "enum":
        values = "".join(f"  {words(v, 'name')}{' ' + words(v, 'initializer') if words(v, 'initializer') else ''},"
                         f"{'  // ' + one if (one := ''.join(v.find('briefdescription').itertext()).strip()) else ''}\n" for v in member.findall("enumvalue"))
        return f"{head}enum {'class ' if member.get('strong') == 'yes' else ''}{name} {{\n{values}}};"
    if kind == "typedef":
        return f"{head}using {name} = {words(member, 'type')};"
    static = "static " if member.get("static") == "yes" and kind == "function" else ""
    given = re.sub(r"=(0|default|delete)$", r" = \1", words(member, "argsstring"))
    value = words(member, "initializer")
    text = f"{head}{static}{words(member, 'type')} {words(member, 'name')}{given} {value if len(value) < 80 else ''}".strip()
    return re.sub(r"(?<=<) | (?=>)", "", text.replace(static + static, static)) + ";"


class Cpp:
    """The headers' declarations by header and line."""

    def __init__(self, scratch):
        inputs = " ".join(f'"{ROOT / folder}"' for folder in FOLDERS)
        done = subprocess.run(["doxygen", "-"], input=f"{SETTINGS}INPUT = {inputs}\nOUTPUT_DIRECTORY = \"{scratch}\"\n", capture_output=True, text=True)
        if done.returncode or done.stderr.strip():
            raise ApiError(f"doxygen: {done.stderr.strip()}")
        self._compounds = [ElementTree.parse(file).getroot()[0] for file in sorted((scratch / "xml").glob("*.xml")) if file.stem != "index"]

    def pages(self):
        """Folder -> page."""
        headers = defaultdict(list)
        for compound in self._compounds:
            kind = compound.get("kind")
            if kind in ("struct", "class") and compound.get("prot") == "public":
                self._put(headers, compound, self._of_class(compound))
            elif kind in ("namespace", "file"):
                for member in compound.iter("memberdef"):
                    if member.get("kind") in ("function", "variable", "typedef", "enum", "define") and said(member):
                        self._put(headers, member, (words(member, "name"), declaration(member), said(member), ""))
        folders, seen = defaultdict(list), set()
        for header in sorted(headers):
            folders[header.rpartition("/")[0]].append(self._of_header(header, headers[header], seen))
        return {folder: f"# C++: {folder}\n\n" + "\n".join(parts) for folder, parts in folders.items()}

    def _put(self, headers, node, item):
        place = node.find("location")
        header = place.get("file").removeprefix(f"{ROOT}/")
        if item[2] or item[3]:
            headers[header].append((int(place.get("line")), item))

    def _of_class(self, compound):
        name = words(compound, "compoundname").removeprefix("hapbench::")
        members = []
        for member in compound.iter("memberdef"):
            if member.get("prot") == "public" and member.get("kind") != "friend" and not words(member, "name").startswith("~"):
                about = said(member)
                text = declaration(member)
                members.append(f"{literal(text, 'cpp')}\n{about}\n" if "\n" in text else f"- `{text.rstrip(';')}`" + (": " + re.sub(r"\s+", " ", about) if about else ""))
        bases = ", ".join("".join(base.itertext()) for base in compound.findall("basecompoundref"))
        return name, f"{compound.get('kind')} {name}" + (f" : public {bases}" if bases else ""), said(compound), "\n".join(members)

    @staticmethod
    def _of_header(header, items, seen):
        overview = OVERVIEW.search((ROOT / header).read_text(encoding="utf-8"))
        about = plain(re.sub(r"^/// ?", "", overview[1], flags=re.M)) if overview else ""
        parts = []
        for _, (name, text, description, members) in sorted(set(items)):
            # Overloads, and what several folders call alike, are found at the first.
            parts.append(entry("cpp-name", name, *((":noindex:",) if name in seen else ()), literal(text, "cpp"), description, members))
            seen.add(name)
        return f"## {header.rpartition('/')[2]}\n\n`#include \"{header}\"`\n\n{about}\n\n" + "\n".join(parts)


def add_cpp(mirror, scratch):
    pages = Cpp(scratch).pages()
    for folder, text in pages.items():
        mirror.add(f"reference/cpp/{folder}", text)
    mirror.add("reference/cpp", "# C++\n\nThe public headers by folder, from their comments. [As a library](../tests/index.md#hapbench-as-a-library) "
               "says how a project of its own uses them.\n\n" + contents((f"reference/cpp/{folder}" for folder in sorted(pages)), hidden=False))


def signature(node, name):
    if isinstance(node, ast.ClassDef):
        fields = [ast.unparse(one) for one in node.body if isinstance(one, ast.AnnAssign)]  # of a data class
        if fields:
            return f"class {name}({', '.join(fields)})"
        made = next((one for one in node.body if isinstance(one, ast.FunctionDef) and one.name == "__init__"), None)
        return f"class {name}" + (re.sub(r"\(self(, )?", "(", signature(made, ""), count=1) if made else "")
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    return f"{name}({ast.unparse(node.args)}){returns}"


def add_python(mirror):
    """What `hapbench.__all__` names, as its module defines it; the package need not be built for that."""
    package = ROOT / "scripts" / "python" / "hapbench"
    trees = [ast.parse(file.read_text(encoding="utf-8")) for file in sorted(package.glob("*.py"))]
    nodes = {node.name: node for tree in trees for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    assigned = next(node for node in ast.parse((package / "__init__.py").read_text(encoding="utf-8")).body if isinstance(node, ast.Assign))
    parts = ["# Python\n\n`import hapbench`, by its docstrings. [The manual](../scripts/python/index.md) shows it at work.\n"]
    for name in ast.literal_eval(assigned.value):
        node = nodes[name]
        members = []
        if isinstance(node, ast.ClassDef):
            members = [f"- `{signature(one, one.name).replace('(self, ', '(').replace('(self)', '()')}`: {in_line(ast.get_docstring(one) or '')}"
                       for one in node.body if isinstance(one, ast.FunctionDef) and not one.name.startswith("_") and ast.get_docstring(one)]
        parts += [f"## {name}\n", entry("python-name", f"hapbench.{name}", literal(signature(node, f"hapbench.{name}"), "python"),
                                       docstring(ast.get_docstring(node) or ""), "\n".join(re.sub(r"\s+", " ", one) for one in members))]
    mirror.add("reference/python", "\n".join(parts))


def docstring(text):
    """Indented parts are code, and so is what stands in backticks."""
    parts = re.split(r"((?:^(?: {4}.*)?\n?)+)", text, flags=re.M)
    return "".join(f"\n{literal(part.strip(chr(10)), 'python')}\n" if part.startswith("    ") else in_line(part) for part in parts)


def in_line(text):
    return "".join(part if part.startswith("`") else plain(part) for part in re.split(r"(`[^`\n]+`)", text))
