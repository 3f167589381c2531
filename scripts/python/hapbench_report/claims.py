"""The ledger: what the thesis claims, what it publishes, what we measure, and the verdict."""
from .json_input import InputError, load_object, member, number_or_none, objects, shown

# Verdict -> (mark, tone). The mark tells verdicts apart without colour.
VERDICTS = {
    "reproduced": ("✓", "good"),
    "reproduced in kind": ("≈", "fair"),
    "not reproduced": ("✗", "bad"),
    "refuted": ("⊘", "bad"),
    "not reproducible": ("–", "none"),
}


def load_claims(file):
    claims = objects(load_object(file), "claims", file)
    for i, claim in enumerate(claims):
        verdict = claim.get("verdict")
        if verdict not in VERDICTS:
            raise InputError(f"{file}: /claims/{i}/verdict: got {shown(verdict)}; allowed: {shown_verdicts()}")
        if claim.get("robustness") is not None:
            member(claim, "robustness", dict, file, f"/claims/{i}")
    return claims


def robustness_text(claim):
    """How a claim's verdict fares over the choices on record, as the ledger's Markdown says it."""
    robustness = claim.get("robustness")
    if not robustness:
        return "not sampled: times of one machine" if claim.get("timing") else ""
    holds, judged, decided_by = (robustness.get(key) for key in ("holds", "judged", "decided_by"))
    text = f"this verdict in {holds} of {judged} samples"
    if isinstance(decided_by, dict):
        return f"{text}; decided by {decided_by.get('choice')} (S = {number_or_none(decided_by.get('index')) or 0:.2f})"
    return text if holds == judged else f"{text}; no single choice decides"


def load_choices(file):
    """What the thesis leaves open: results/reference/choices.json."""
    return objects(load_object(file), "choices", file)


def shown_verdicts():
    return ", ".join(f'"{verdict}"' for verdict in VERDICTS)


def verdict_counts(claims):
    return {verdict: sum(claim["verdict"] == verdict for claim in claims) for verdict in VERDICTS}
