"""Scenes behind the verdicts on claims."""
from answers import scene


@scene
def verdicts(bench):
    """Verdicts on claims, by tests that give the rules of claims numbers beside their thresholds,
    for each verdict and for another."""
    for word, said, refused in (
        ("reproduced", '{"T4", costs, {{"", reproduced}', "not_reproduced"),
        ("not reproduced", '"1.reduced_mean=1.1 1.reduced_max=2", not_reproduced', "reproduced"),
        ("reproduced in kind", '"outside_taps=15", in_kind', "reproduced"),
        ("refuted", '"last_max=1.3 limit_max=1.3", refuted', "reproduced"),
        (
            "holds",
            '{"T2b", "force=0.2 raw=55 kept=20 | force=1.9 raw=56", {{"", holds}',
            "does_not_hold",
        ),
        ("does not hold", '"0.raw=56 1.raw=57", does_not_hold', "holds"),
        ("not reproducible", "EXPECT_EQ(finding.verdict, not_reproducible)", "reproduced"),
    ):
        bench.proven(
            f"{word} (verdict on a claim)",
            "tests/scenarios/thesis/claims_test.cpp",
            "Claims.AreJudgedByTheirThresholds",
            said,
            refused,
        )
