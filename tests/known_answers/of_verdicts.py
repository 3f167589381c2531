"""Known answers for the verdicts on claims."""
from answers import scene


@scene
def verdicts(bench):
    """Checks that a test in C++ covers each verdict on claims. The test applies the rules of the claims to numbers on
    both sides of the thresholds of the rules."""
    for word, accepted, rejected in (
        ("replicated", '{"T4", costs, {{"", replicated}', "not_replicated"),
        ("not replicated", '"1.reduced_mean=1.1 1.reduced_max=2", not_replicated', "replicated"),
        ("qualitatively replicated", '"outside_taps=15", qualitatively', "replicated"),
        ("contradicted", '"last_max=1.3 limit_max=1.3", contradicted', "replicated"),
        ("not judged", '"raw_mean=42", not_judged', "replicated"),
        ("consistent in simulation", '"0.original=0.6,0.65,0.7", consistent', "not_consistent"),
        (
            "not consistent in simulation",
            '"0.original=0.5,0.6,0.4 0.shaped=0.6,0.4,0.5", not_consistent',
            "consistent",
        ),
        (
            "holds",
            '{"T2b", "force=0.2 raw=55 kept=20 | force=1.9 raw=56", {{"", holds}',
            "does_not_hold",
        ),
        ("does not hold", '"0.raw=56 1.raw=57", does_not_hold', "holds"),
        ("not testable", "EXPECT_EQ(finding.verdict, not_testable)", "replicated"),
    ):
        bench.proven(
            f"{word} (verdict on a claim)",
            "tests/scenarios/thesis/claims_test.cpp",
            "Claims.AreJudgedByTheirThresholds",
            accepted,
            rejected,
        )
