"""The ledger: what the thesis claims, what it publishes, what we measure, and the verdict."""
from .json_input import InputError, load_object, objects, shown

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
    return claims


def shown_verdicts():
    return ", ".join(f'"{verdict}"' for verdict in VERDICTS)


def verdict_counts(claims):
    return {verdict: sum(claim["verdict"] == verdict for claim in claims) for verdict in VERDICTS}
