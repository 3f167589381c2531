"""Tables of the ledger (claims.json) and of its robustness, as results/reference holds them."""
import json
import re

from .manuals import ROOT

REFERENCE = ROOT / "results" / "reference"
VERDICTS = ("reproduced", "reproduced in kind", "not reproduced", "refuted", "not reproducible")
TASKS = {"D1": "upright, 0.52 mm aside", "D2": "upright, centre", "D3": "turning, 3 mm high", "D4": "turning, 4 mm high"}
PAIR = re.compile(r"success(?: rate)? (.+?) vs ([^;(]+)")


def read(name):
    return json.loads((REFERENCE / name).read_text(encoding="utf-8"))


def verdicts(_old=""):
    """How many claims have which verdict, and which."""
    claims = read("claims.json")["claims"]
    lines = ["| verdict | claims | which |", "|---|---|---|"]
    for verdict in VERDICTS:
        ids = [claim["id"] for claim in claims if claim["verdict"] == verdict]
        lines.append(f"| {verdict} | {len(ids)} of {len(claims)} | {' '.join(ids)} |")
    return "\n".join(lines)


def experiments(_old=""):
    """Success in the thesis's experiments, measured with simulated subjects and published with people."""
    by_id = {claim["id"]: claim for claim in read("claims.json")["claims"]}
    lines = ["| task and target | original algorithm, ours (published) | stiffness shaping, ours (published) |", "|---|---|---|"]
    for id_, task in TASKS.items():
        published = PAIR.search(re.sub(r" \(printed [^)]*\)", "", by_id[id_]["published"]))
        measured = PAIR.search(by_id[id_]["measured"])
        cells = (f"{measured[i].strip()} ({published[i].strip()})" for i in (1, 2))
        lines.append(f"| {task} ({id_}) | {' | '.join(cells)} |")
    return "\n".join(lines)


def robustness(_old=""):
    """How firmly the verdicts hold over the choices on record. Of claims whose verdict has changed since, it says so."""
    record = read("robustness.json")
    on_record = {claim["id"]: claim["verdict"] for claim in read("claims.json")["claims"]}
    rows = [claim for claim in record["claims"] if claim["judged"]]
    current = [claim for claim in rows if claim["on_record"] == on_record.get(claim["id"])]
    always = [claim for claim in current if claim["holds"] == claim["judged"]]
    lines = [f"Of {len(rows)} claims that were sampled, {len(current)} have the same verdict today; of these, {len(always)} hold it in "
             "every sample. The others:", "", "| claim | verdict | this verdict in | decided by (first-order Sobol index) |", "|---|---|---|---|"]
    for claim in current:
        if claim in always:
            continue
        by = claim["decided_by"]
        decided = f"`{by['choice']}` ({by['index']:.2f})" if by else "no single choice"
        lines.append(f"| {claim['id']} | {claim['on_record']} | {claim['holds']} of {claim['judged']} | {decided} |")
    stale = [claim["id"] for claim in rows if claim not in current]
    if stale:
        lines += ["", f"To be sampled anew, since their verdict has changed: {', '.join(stale)}."]
    return wrapped(lines)


def wrapped(lines, width=110):
    """Sentences in lines of that width; tables stay."""
    import textwrap

    return "\n".join(line if line.startswith("|") else "\n".join(textwrap.wrap(line, width)) for line in lines)


MAKERS = {"verdicts": verdicts, "experiments": experiments, "robustness": robustness}
