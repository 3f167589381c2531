"""The ledger beside the results: what was measured for a claim, and which claims a figure draws."""
import re

LEDGER = "claims.json"
NUMBER = re.compile(r"(?:[A-F]\.)?\d+")


def cases(results, id_):
    """The cases of a claim: name and numbers of each."""
    return next(claim["cases"] for claim in results.json(LEDGER)["claims"] if claim["id"] == id_)


def rows(figure, claims):
    """What the ledger measured for each claim that a figure draws, but for times: where that changes, the figure is stale."""
    numbers = set(NUMBER.findall(figure.thesis))
    drawn = {}
    for claim in claims:
        named = {number for part in claim["place"].split(", ") if part.startswith("Fig. ") for number in NUMBER.findall(part)}
        if not claim["timing"] and (claim["id"] in figure.rows or named & numbers):
            drawn[claim["id"]] = claim["measured"]
    return drawn
