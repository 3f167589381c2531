"""The fields that hapbench prints, by its own word, and those without an answer."""
import json
import re

from answers import PROGRAM, ran

# Members of JSON that say where and how, not what.
NO_TABLES = {"run", "import"}  # commands whose JSON does not repeat a table
NO_WORDS = {"file of the results"}
TOLERANCES = "tolerances"
DIAGNOSIS = "diagnosis"
NO_ANSWERS = {"provenance", "name", "algorithm", "scenario"}


def described(what):
    done = ran(PROGRAM, "describe", what, "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def keys_of(data):
    """Keys of values, and keys of objects and lists of objects, which only group them."""
    if isinstance(data, list):
        found = [keys_of(value) for value in data]
        return set().union(*(keys for keys, _ in found)), set().union(*(groups for _, groups in found))
    if not isinstance(data, dict):
        return set(), set()
    members = {key: value for key, value in data.items() if key not in NO_ANSWERS and key not in (TOLERANCES, DIAGNOSIS)}
    members.update({f"{TOLERANCES}.{name}": value for name, value in data.get(TOLERANCES, {}).items()})  # beside the metrics' own
    members.update({f"{DIAGNOSIS}.{name}": value for finding in data.get(DIAGNOSIS, []) for name, value in finding.items()})  # words of other keys
    groups = {key for key, value in members.items() if isinstance(value, dict) or isinstance(value, list) and any(isinstance(v, dict) for v in value)}
    within = [keys_of(members[key]) for key in groups]
    return (set(members) - groups).union(*(keys for keys, _ in within)), groups.union(*(more for _, more in within))


def printed_fields(benches):
    """Metrics, columns as FILE:COLUMN, words as "WORD (KIND)", and keys of JSON that are neither as "COMMAND --json: KEY"."""
    metrics = [metric["name"] for metric in described("metrics")[0]["metrics"]]
    parts = {part for name in metrics for part in name.split(".")}
    fields, columns = [re.sub(r"^targets\.\d+", "targets.PLACE", name) for name in metrics], set()
    for table in described("columns"):
        names = [column["name"] for column in table["columns"]]
        columns |= set(names)
        shared = table["name"] in ("sweep.csv", "comparison.csv")
        fields += [f"{table['name']}:{name.split('.')[0] if name.startswith(TOLERANCES) else name}" for name in names if not shared or name not in metrics]
        fields += [f"{table['name']}:metrics"] if shared else []
    fields += [f"{word['name']} ({word['kind']})" for word in described("words")["words"] if word["kind"] not in NO_WORDS]
    found = [(command, *keys_of(data)) for bench in benches for command, data in bench.printed]  # runs of compare are those of run
    groups = {(command, key) for command, _, grouping in found for key in grouping}
    keys = {(command, key) for command, leaves, _ in found for key in leaves if key not in parts or command != "run"} - groups
    of_runs = {key for command, key in keys if command == "run"}
    fields += [f"{command} --json: {key}" for command, key in sorted(keys) if command in NO_TABLES or key not in columns | of_runs]
    return list(dict.fromkeys(fields))


def open_fields(fields, answers):
    """Those without an answer that refuses a naive one."""
    answered = {answer.field for answer in answers if answer.naive}
    return [field for field in fields if field not in answered]
