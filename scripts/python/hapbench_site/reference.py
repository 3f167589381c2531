"""Pages that the program writes: its commands, the fields of a scenario, metrics and columns, algorithms and other models, and
the bundled scenarios."""
import json
import re
from itertools import groupby

MODELS = {"algorithms": ("Algorithms", {"algorithm"}),
          "models": ("Depth models, stages, integrators, presets", {"depth model", "stage", "integrator", "preset"})}
# A field and what is said of it, by their indents, as "describe" prints it.
FIELD = r"^ {%d}(\S+)\n((?: {%d}.*\n?)+)"
A_PROFILE = "motion.orientation.tilt_rad"
BY_HAND = re.compile(r"([\\`*_\[\]<>|~$#!&{}])")


def plain(text):
    """Text that Markdown leaves as it is."""
    text = BY_HAND.sub(r"\\\1", text)
    return re.sub(r"^(\s*)(?=[+=:]|-+$)", r"\1\\", text, flags=re.M)


def entry(kind, name, *paragraphs):
    """A thing of a kind (conf.py lists them) that the search knows by its name."""
    body = "\n\n".join(filter(None, paragraphs))
    return f"`````{{{kind}}} {name}\n{body}\n`````\n"


def literal(text, language="text"):
    return f"````{language}\n{text.strip(chr(10))}\n````\n"


class Reference:
    """`program`: a hapbench_docs.program.Program."""

    def __init__(self, program, mirror):
        self._program, self._mirror = program, mirror
        self._names = set()

    def add_all(self):
        for page in (self._commands, self._fields, self._metrics, self._models, self._scenarios):
            page()

    def _text(self, *words):
        return self._program.run(words, self._mirror.folder)

    def _json(self, *words):
        return json.loads(self._text(*words, "--json"))

    def _named(self, kind, name, *paragraphs):
        """An entry; further ones of a name are told apart by no link of their own."""
        first = (kind, name) not in self._names
        self._names.add((kind, name))
        return entry(kind, name, *(() if first else (":noindex:",)), *paragraphs)

    def _commands(self):
        text = self._text("--help")
        commands = re.findall(r"^  ([a-z]+) {2,}[A-Z]", text.split("\nCommands:\n")[1], re.M)
        parts = ["# Commands\n\nAs `--help` of each prints it. [The manual](../scenarios/index.md#commands) shows them at work.\n", literal(text)]
        for name in commands:
            parts += [f"## {name}\n", self._named("command", f"hapbench {name}"), literal(self._text(name, "--help"))]
        self._mirror.add("reference/commands", "\n".join(parts))

    def _fields(self):
        parts = ["# Fields of a scenario\n\nAs `hapbench describe FIELD` has them; "
                 "[the manual](../scenarios/index.md#write-a-scenario) says how a scenario is written.\n"]
        for name, about in re.findall(FIELD % (2, 6), self._text("describe", "scenario").split("\nscenario\n")[1], re.M):
            parts += [*([] if "." in name else [f"## {name}\n"]), *self._field(name, about)]
        parts += ["## Functions of time\n", *self._types(A_PROFILE, "profile")]
        self._mirror.add("reference/fields", "\n".join(parts))

    def _field(self, name, about):
        yield self._named("field", name, "\\\n".join(plain(line.strip()) for line in about.splitlines()))
        words = " ".join(about.split())
        if 'object whose "type" is one of' in words and '"ramp"' not in words:
            yield from self._types(name, name)

    def _types(self, field, name):
        """Headings of the types that a field may have, each with its fields."""
        for kind, summary, fields in re.findall(r'^  type "(\w+)": (.*)\n((?: {6}.*\n?)*)', self._text("describe", field), re.M):
            yield f"### {name}: {kind}\n\n{plain(summary)}\n"
            for inner, about in re.findall(FIELD % (6, 10), fields, re.M):
                yield from self._field(f"{name}.{inner}", about)

    def _metrics(self):
        parts = ["# Metrics and columns\n\n[The manual of results](../results/index.md) says where they are written.\n\n## Metrics of summary.json\n"]
        for one in self._json("describe", "metrics")[0]["metrics"]:
            parts.append(self._named("metric", one["name"], f"[{one['unit']}] {plain(one['meaning'])}"))
        for file in self._json("describe", "columns"):
            if "columns" in file:
                parts.append(f"## {file['name']}\n\n{plain(file['holds'])}\n")
                parts += [f"- `{one['name']}`{one['unit'] and ' [' + one['unit'] + ']'}: {plain(one['meaning'])}" for one in file["columns"]] + [""]
        self._mirror.add("reference/metrics", "\n".join(parts))

    def _models(self):
        listed = self._json("list")
        for page, (title, kinds) in MODELS.items():
            parts = [f"# {title}\n\nAs `hapbench describe NAME` has them; [the manual of algorithms](../algorithms/index.md) compares them, that of "
                     "[devices](../device_model/index.md) has the presets at work.\n"]
            for one in listed:
                if one["kind"] in kinds:
                    parts += [f"## {one['name']}\n", self._named("algorithm" if page == "algorithms" else "model", one["name"]),
                              literal(self._text("describe", one["name"]))]
            self._mirror.add(f"reference/{page}", "\n".join(parts))

    def _scenarios(self):
        parts = ["# Bundled scenarios\n\n`hapbench run NAME` runs one; [the gallery](../scenarios/GALLERY.md) shows some.\n"]
        bundled = (one for one in self._json("list") if one["kind"] == "scenario")
        for group, scenarios in groupby(bundled, key=lambda one: one["group"]):
            parts += [f"## {group}\n", *(self._named("scenario", one["name"], plain(one["summary"]), plain(one.get("source", ""))) for one in scenarios)]
        self._mirror.add("reference/scenarios", "\n".join(parts))
