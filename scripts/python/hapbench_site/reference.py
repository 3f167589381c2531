"""Pages that the program writes: its commands, the fields of a scenario, metrics and columns, algorithms and other models, and
the bundled scenarios."""
import json
import re

KINDS = {"algorithm": ("algorithms", "Algorithms"), "depth model": ("models", "Depth models"), "stage": ("models", "Stages"),
         "integrator": ("models", "Integrators")}
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
        self.names = {"command": set(), "field": set(), "metric": set(), "algorithm": set()}

    def add_all(self):
        for page in (self._commands, self._fields, self._metrics, self._models, self._scenarios):
            page()

    def _text(self, *words):
        return self._program.run(words, self._mirror.folder)

    def _json(self, *words):
        return json.loads(self._text(*words, "--json"))

    def _named(self, kind, name, *paragraphs):
        """An entry; further ones of a name are told apart by no link of their own."""
        first = name not in self.names.setdefault(kind, set())
        self.names[kind].add(name)
        return entry(kind, name, *(() if first else (":noindex:",)), *paragraphs)

    def _commands(self):
        text = self._text("--help")
        commands = re.findall(r"^  ([a-z]+) {2,}[A-Z]", text.split("\nCommands:\n")[1], re.M)
        parts = ["# Commands\n\nAs `--help` of each prints it. [The manual](../scenarios/index.md#commands) shows them at work.\n", literal(text)]
        for name in commands:
            parts += [f"## {name}\n", self._named("command", f"hapbench {name}"), literal(self._text(name, "--help"))]
        self._mirror.add("reference/commands", "\n".join(parts))

    def _fields(self):
        whole_schema = json.loads(self._text("describe", "schema"))
        definitions, schema = whole_schema["definitions"], whole_schema["else"]  # "then" is of a scenario that extends another
        parts = ["# Fields of a scenario\n\nAs `hapbench describe FIELD` has them; "
                 "[the manual](../scenarios/index.md#write-a-scenario) says how a scenario is written. SI units throughout.\n"]
        whole, rest = [], []
        for name, field in schema["properties"].items():
            inner = list(self._inner(name, field))
            if inner:
                rest += [f"## {name}\n", self._field(name, field), *inner]
            else:
                whole.append(self._field(name, field))
        values = [f"## {name}\n\n{plain(one.get('description', 'In place of a number: a function of time.' if name == 'profile' else ''))}\n\n"
                  + "\n".join(self._inner(name, one)) for name, one in definitions.items()]
        self._mirror.add("reference/fields", "\n".join([*parts, "## Scenario\n", *whole, *rest, *values]))

    def _field(self, path, field):
        default = f"; default `{json.dumps(field['default'])}`" if "default" in field else ""
        return self._named("field", path, f"{allowed(field)}{default}", plain(field.get("description", "")))

    def _inner(self, path, field):
        """Entries of the fields of an object, of each type that it may have, and of the objects of a list."""
        for name, one in ({} if path == "expect.metrics" else field.get("properties", {})).items():
            if "const" not in one:
                yield self._field(f"{path}.{name}", one)
                yield from self._inner(f"{path}.{name}", one)
        for one in (*field.get("oneOf", ()), *field.get("anyOf", ())):
            kind = one.get("properties", {}).get("type", {}).get("const")
            if kind is not None:
                yield f"### {path}: {kind}\n\n{plain(one.get('description', ''))}\n"
            yield from self._inner(path, one)
        if isinstance(field.get("items"), dict):
            yield from self._inner(f"{path}[]", field["items"])

    def _metrics(self):
        parts = ["# Metrics and columns\n\n[The manual of results](../results/index.md) says where they are written.\n\n## Metrics of summary.json\n"]
        for one in self._json("describe", "metrics")[0]["metrics"]:
            parts.append(self._named("metric", one["name"], f"[{one['unit']}] {plain(one['meaning'])}"))
        for file in self._json("describe", "columns"):
            if "columns" in file:
                parts.append(f"## {file['name']}\n\n{plain(file['holds'])}\n")
                parts += [f"- `{one['name']}` [{one['unit']}]: {plain(one['meaning'])}" if one["unit"] else f"- `{one['name']}`: {plain(one['meaning'])}"
                          for one in file["columns"]]
                parts.append("")
        self._mirror.add("reference/metrics", "\n".join(parts))

    def _models(self):
        pages = {"algorithms": ["# Algorithms\n\nAs `hapbench describe NAME` has them; [the manual](../algorithms/index.md) compares them.\n"],
                 "models": ["# Depth models, stages, integrators, presets\n\nAs `hapbench describe NAME` has them.\n"]}
        listed = self._json("list")
        for kind, (page, title) in KINDS.items():
            if page != "algorithms":
                pages[page].append(f"## {title}\n")
            pages[page] += [self._model(one) for one in listed if one["kind"] == kind]
        pages["models"].append("## Presets of devices\n")
        for one in listed:
            if one["kind"] == "preset":
                pages["models"] += [f"### {one['name']}\n", literal(self._text("describe", one["name"]))]
        for page, parts in pages.items():
            self._mirror.add(f"reference/{page}", "\n".join(parts))

    def _model(self, listed):
        found = self._json("describe", listed["name"])
        one = found if isinstance(found, dict) else next(one for one in found if one.get("kind") == listed["kind"])
        kind = "algorithm" if listed["kind"] == "algorithm" else "model"
        facts = [f"{title}: {plain(one[key])}" if key != "formula" else literal(one[key])
                 for title, key in (("", "formula"), ("Source", "source"), ("Known failure", "known_failure")) if one.get(key)]
        given = [f"- `{p['name']}`: {plain(p['range'])}; default `{p['default']}`. {plain(p['meaning'])}" for p in one["parameters"]]
        heading = "##" if kind == "algorithm" else "###"
        return f"{heading} {one['name']}\n\n" + self._named(kind, one["name"], plain(one["summary"]), *facts, "\n".join(given))

    def _scenarios(self):
        parts = ["# Bundled scenarios\n\n`hapbench run NAME` runs one; [the gallery](../scenarios/GALLERY.md) shows some.\n"]
        group = None
        for one in self._json("list"):
            if one["kind"] == "scenario":
                if one["group"] != group:
                    group = one["group"]
                    parts.append(f"## {group}\n")
                parts.append(self._named("scenario", one["name"], plain(one["summary"]), plain(one.get("source", ""))))
        self._mirror.add("reference/scenarios", "\n".join(parts))


def allowed(field):
    """What a field may be, in a few words."""
    choices = field.get("oneOf") or field.get("anyOf")
    if "$ref" in field:  # a definition has a heading of its own
        name = field["$ref"].rpartition("/")[2]
        return f"a [{name}](#{name})"
    if "enum" in field:
        return "one of " + ", ".join(f"`{json.dumps(one)}`" for one in field["enum"])
    if "const" in field:
        return f"`{json.dumps(field['const'])}`"
    if choices and not all(set(one) == {"required"} for one in choices):
        types = [one["properties"]["type"]["const"] for one in choices if "const" in one.get("properties", {}).get("type", {})]
        others = [allowed(one) for one in choices if "const" not in one.get("properties", {}).get("type", {}) and set(one) != {"required"}]
        return " or ".join([*others, *(["an object with a `type`: " + ", ".join(f"`{one}`" for one in types)] if types else [])])
    kind = field.get("type", "any JSON")
    bounds = [f"{sign} {field[key]:g}" for key, sign in (("minimum", "≥"), ("exclusiveMinimum", "\\>"), ("maximum", "≤"), ("exclusiveMaximum", "\\<")) if key in field]
    if kind == "array" and isinstance(field.get("items"), dict):
        low, high = field.get("minItems", 0), field.get("maxItems")
        count = f"{low}" if low == high else f"{low} to {high}" if high is not None else f"at least {low}"
        return f"a list of {count}, each {allowed(field['items'])}"
    return " ".join([{"number": "a number", "integer": "an integer", "boolean": "true or false", "string": "a text",
                      "object": "an object", "array": "a list", "null": "null"}.get(kind, str(kind)), ", ".join(bounds)]).strip()


