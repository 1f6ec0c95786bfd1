# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""What verdict follows from a result's own interval and reason, by the rules of docs/method.md, section 5."""


def verdict_that_follows(region):
    """Of a region of result.json whose modulus was unknown. Fails where its reason tells another number than its
    interval, or an organ that cannot be told has an interval that claims more than the prior."""
    low, high = region["interval_kpa"]
    words = region["reason"].split()
    contradicts = region["contradicts_prior"]
    assert contradicts == region["reason"].startswith("the search ended at"), region
    if contradicts:
        if region["sd_ln_stiffness"] <= 0.8:  # two thirds of the prior's 1.2
            return "weak"
        assert low <= 9.6 and high >= 1050 or high / low > 110, region
        return "not identifiable"
    assert 0 < low < high
    if region["verdict"] != "not identifiable":
        assert low < region["stiffness_kpa"] < high
    if region["reason"].startswith("the 95 % interval spans a factor of"):
        told = float(words[words.index("of") + 1].rstrip(";"))
        assert abs(told - high / low) <= 0.006 * told + 0.05, region
        return "recovered" if high <= 2 * low else "weak"
    if region["reason"].startswith("only a"):
        bound = low if "lower bound" in region["reason"] else high
        told = float(words[words.index("known,") + 1])
        assert abs(told - bound) <= 0.01 * bound, region
        return "weak"
    assert abs(high / low / 110.4 - 1) < 0.01, region  # the prior's: exp(2 * 1.96 * 1.2)
    return "not identifiable"
