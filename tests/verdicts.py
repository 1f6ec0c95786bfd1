# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""What verdict follows from a result's own interval and reason, by the rules of docs/method.md, section 5."""


def verdict_that_follows(region):
    """Of a region of result.json whose modulus was unknown. Fails where its reason tells another number than its
    interval, or an organ that cannot be told has an interval that claims more than the prior."""
    low, high = region["interval_kpa"]
    words = region["reason"].split()
    contradicts = region["misled_probability"] >= 0.1
    assert contradicts == ("something else than stiffness" in region["reason"]), region
    assert 0 < low < high
    if region["verdict"] != "not identifiable":
        assert low < region["stiffness_kpa"] < high
    if region["reason"].startswith("the 95 % interval spans a factor of"):
        told = float(words[words.index("of") + 1].rstrip(";"))
        assert abs(told - high / low) <= 0.006 * told + 0.05, region
        return "recovered" if high <= 2 * low and not contradicts else "weak"
    if region["reason"].startswith("only a"):
        bound = low if "lower bound" in region["reason"] else high
        told = float(words[words.index("known,") + 1])
        assert abs(told - bound) <= 0.01 * bound, region
        return "weak"
    of_prior = high / low / 110.4  # exp(2 * 1.96 * 1.2)
    assert abs(of_prior - 1) < 0.01 or contradicts and of_prior > 1, region
    return "not identifiable"
