"""Random scenarios that the program accepts: half are drawn from the schema field by field, half are scenes that come with the
program in which some fields are drawn anew. Sizes are such that a run takes milliseconds."""
import json
import math
import random

# Sizes that a number of a unit usually has, [from, to] in equal ratios: the last part of the field's name that is found here.
USUAL = {"m": (1e-4, 2e-2), "s": (1e-4, 1.0), "N": (1e-2, 20.0), "kg": (1e-2, 5.0), "rad": (1e-2, 1.5), "Hz": (1.0, 500.0),
         "N_per_m": (10.0, 1e5), "m_per_s": (1e-3, 0.5), "N_s_per_m": (0.1, 100.0)}
BEYOND = 0.03  # of the numbers are at an end of what is allowed
STEPS, STEP_S, MOST, FINEST = 60, (1e-4, 4e-3), 300, 3e-4  # rows of a run, their distance, counts, distances of points [m]


def unit_of(name):
    return next((unit for unit in sorted(USUAL, key=len, reverse=True) if name.endswith("_" + unit)), None)


class Scenes:
    """Draws scenarios. `bundled`: effective scenarios that come with the program; `files`: {"file of environment", …: path}."""

    def __init__(self, schema, bundled, files, seed):
        self.root, self.bundled, self.files, self.random = schema, bundled, files, random.Random(seed)
        self.schema = schema["else"]

    def scene(self):
        scene = self.drawn(self.schema, "") if self.random.random() < 0.5 else self.changed()
        for key in ("extends", "$schema", "expect", "bounds"):
            scene.pop(key, None)
        scene["time"] = {"step_s": self.between(*STEP_S), "steps": self.random.randint(1, STEPS)}
        small(scene)
        return scene

    def changed(self):
        """A scene that comes with the program, with some parts drawn anew."""
        scene = json.loads(json.dumps(self.random.choice(self.bundled)))
        for _ in range(self.random.randint(1, 6)):
            schema, part, name = self.schema, scene, ""
            while True:
                schema = self.branch_of(schema, part)
                fields = [f for f in schema.get("properties", {}) if f not in ("type", "extends", "$schema")]
                if not fields:
                    break
                name = self.random.choice(fields)
                inside = part.get(name)
                if not isinstance(inside, dict) or self.random.random() < 0.2:
                    part[name] = self.drawn(schema["properties"][name], name)
                    break
                schema, part = schema["properties"][name], inside
        return scene

    def resolved(self, schema):
        while True:
            if "$ref" in schema:
                found = self.root
                for key in schema["$ref"].split("/")[1:]:
                    found = found[key]
                schema = found
            elif "allOf" in schema:
                schema = {**schema["allOf"][0], **{k: v for k, v in schema.items() if k not in ("allOf", "description")}}
            else:
                return schema

    def branch_of(self, schema, part):
        """The one of several forms that an object of the scene has."""
        schema = self.resolved(schema)
        for form in (self.resolved(f) for f in schema.get("oneOf", schema.get("anyOf", []))):
            kind = form.get("properties", {}).get("type", {}).get("const")
            if form.get("type") == "object" and (kind is None or kind == part.get("type")):
                return self.branch_of(form, part)
        return schema

    def drawn(self, schema, name):
        schema = self.resolved(schema)
        forms = schema.get("oneOf") or schema.get("anyOf")
        if "default" in schema and self.random.random() < 0.3:
            return json.loads(json.dumps(schema["default"]))
        if forms:
            return self.drawn(self.random.choice(forms), name)
        if "const" in schema:
            return schema["const"]
        if "enum" in schema:
            return self.random.choice(schema["enum"])
        kind = schema.get("type", "object")
        kind = self.random.choice(kind) if isinstance(kind, list) else kind
        return getattr(self, f"{kind}_")(schema, name)

    def object_(self, schema, name):
        wanted = schema.get("required", [])
        return {field: self.drawn(part, field) for field, part in schema.get("properties", {}).items()
                if field in wanted or self.random.random() < 0.25}

    def array_(self, schema, name):
        least, most = schema.get("minItems", 0), schema.get("maxItems", 4)
        count, items = self.random.randint(least, max(least, min(most, least + 3))), schema.get("items", {})
        if isinstance(items, list):
            return [self.drawn(item, name) for item in items]
        drawn = [self.drawn(items, name) for _ in range(count)]
        ascends = drawn and all(isinstance(p, list) and p and isinstance(p[0], (int, float)) for p in drawn)
        return sorted(drawn) if ascends else drawn

    def string_(self, schema, name):
        return self.random.choice(self.files.get(name, ["a", "zwölf", "x y", "\u4e09", "a/b", "%s", ""]))

    def boolean_(self, schema, name):
        return self.random.random() < 0.5

    def null_(self, schema, name):
        return None

    def integer_(self, schema, name):
        low, high = int(schema.get("minimum", 0)), int(schema.get("maximum", MOST))
        return self.random.randint(low, max(low, min(high, low + self.random.choice((2, 10, MOST)))))

    def number_(self, schema, name):
        low = schema.get("minimum", schema.get("exclusiveMinimum", -1e9))
        high = schema.get("maximum", schema.get("exclusiveMaximum", 1e9))
        if self.random.random() < BEYOND:
            return self.random.choice([end for end in (low, high) if end not in (schema.get("exclusiveMinimum"), schema.get("exclusiveMaximum"))] or [1.0])
        unit, default = unit_of(name), schema.get("default")
        if isinstance(default, (int, float)) and default != 0.0 and not isinstance(default, bool):
            number = default * self.between(0.2, 5.0)
        else:
            number = self.between(*USUAL[unit]) if unit else self.between(1e-2, 2.0)
            number *= self.random.choice((1.0, -1.0)) if low < 0.0 else 1.0
        inside = 1e-9 * max(1.0, abs(low)) if "exclusiveMinimum" in schema else 0.0
        return min(max(number, low + inside), high)

    def between(self, low, high):
        return math.exp(self.random.uniform(math.log(low), math.log(high)))


def small(part, name=""):
    """Takes from a scene what only makes it slow."""
    for key, value in part.items() if isinstance(part, dict) else enumerate(part):
        if isinstance(value, (dict, list)):
            small(value, str(key))
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            if key in ("grid_m", "spacing_m"):
                part[key] = max(value, FINEST)
            elif isinstance(value, int) and key != "seed":
                part[key] = min(value, MOST)
